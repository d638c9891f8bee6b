// What is not a record, and wrong use of the writer, is refused in one line.
#include <fstream>

#include "gmock/gmock.h"
#include "pivnp/io/hdf5/hdf5.hpp"
#include "sample.hpp"

namespace pivnp::io {
namespace {

using sample::message_of;
using ::testing::HasSubstr;

using RecordRefusals = sample::OfARecord;

TEST_F(RecordRefusals, FilesThatAreNoRecordsAreRefusedInOneLine) {
  const auto open = [&](const std::filesystem::path& p) { return message_of<InputError>([&] { RecordReader r(p); }); };
  EXPECT_THAT(open(directory.path / "none.h5"), HasSubstr("none.h5: no such file"));
  EXPECT_THAT(open(directory.path), HasSubstr("is a folder"));
  std::ofstream(directory.path / "text.h5") << "not HDF5 at all\n";
  EXPECT_THAT(open(directory.path / "text.h5"), HasSubstr("text.h5: not an HDF5 file"));
  std::ofstream(directory.path / "empty.h5");
  EXPECT_THAT(open(directory.path / "empty.h5"), HasSubstr("not an HDF5 file"));
  const auto with = [&](const char* schema, const char* version) {
    h5::OutputFile f(directory.path / "other.h5");
    if (schema) f.attribute("/", "schema", schema);
    if (version) f.attribute("/", "schema_version", version);
    f.commit();
    return open(directory.path / "other.h5");
  };
  EXPECT_THAT(with(nullptr, nullptr), HasSubstr("without the attribute 'schema'"));
  EXPECT_THAT(with("plainer", "1.0"), HasSubstr("schema 'plainer', expected 'pivnp'"));
  EXPECT_THAT(with("two\nlines", "1.0"), HasSubstr("attribute 'schema' holds control characters"));
  EXPECT_THAT(with(std::string(1000, 'x').c_str(), "1.0").size(), testing::Lt(300u));
  EXPECT_THAT(with("pivnp", "2.0"), HasSubstr("schema version '2.0', expected 1.x"));
  EXPECT_THAT(with("pivnp", "old"), HasSubstr("schema version 'old'"));
  EXPECT_THAT(with("pivnp", nullptr), HasSubstr("'schema_version' is missing"));
  EXPECT_THAT(with("pivnp", "1.9"), HasSubstr("'command' is missing"));  // a later minor version is read
}

TEST_F(RecordRefusals, NamesThatDoNotPrintAreRefusedInOneLine) {
  h5::OutputFile f(directory.path / "other.h5");
  for (const char* group : {"/compare", "/compare/metrics", "/compare/metrics/a\nb"}) f.group(group);
  f.commit();
  const h5::Source source(directory.path / "other.h5");
  EXPECT_THAT(message_of<InputError>([&] { source.children("/compare/metrics"); }),
              AllOf(HasSubstr("/compare/metrics: holds 'a?b'"), Not(HasSubstr("\n"))));
}

TEST_F(RecordRefusals, ATruncatedRecordIsRefusedAtEveryLength) {
  sample::run(directory.path, size, false);
  const auto whole = std::filesystem::file_size(record);
  const std::filesystem::path cut = directory.path / "cut.h5";
  for (int k = 1; k <= 16; ++k) {
    std::filesystem::copy_file(record, cut, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut, whole * static_cast<std::uintmax_t>(16 - k) / 16);
    const std::string message = message_of<InputError>([&] { RecordReader r(cut); });
    EXPECT_THAT(message, HasSubstr("cut.h5: "));
  }
}

TEST_F(RecordRefusals, MissingPartsAndWrongShapesAreNamed) {
  sample::run(directory.path, size, false);
  const RecordReader r(record);
  EXPECT_THAT(message_of<InputError>([&] { r.motion("npp"); }), HasSubstr("no motion 'npp'; did you mean 'np'"));
  EXPECT_THAT(message_of<InputError>([&] { r.pair(5); }), HasSubstr("/piv/pair: has 5 items, item 5 was asked for"));
  h5::OutputFile f(directory.path / "piece.h5");
  f.group("/piv");
  f.write("/piv/pair", std::vector<std::int32_t>{0, 1}, "");
  const h5::Source source = f.source();
  EXPECT_THAT(message_of<InputError>([&] { source.dataset("/piv/status"); }), HasSubstr("/piv/status: is missing"));
  EXPECT_THAT(message_of<InputError>([&] { source.dataset("/motion/np/u"); }), HasSubstr("/motion/np/u: is missing"));
  EXPECT_THAT(message_of<InputError>([&] {
                source.dataset("/piv/pair").expect({1, 2});
              }),
              HasSubstr("has shape [2], expected [1, 2]"));
}

TEST_F(RecordRefusals, WrongUseIsNoSilentMatter) {
  RecordWriter w(directory.path, sample::head(size), false);
  EXPECT_THROW(w.begin_motion("a/b", sample::particles(size)), InputError);
  EXPECT_THROW(w.begin_motion("np", ParticleSet{}), InputError);
  EXPECT_THROW(w.add_frame("np", sample::frame(size, 0, false)), std::logic_error);
  VectorField other = sample::pair(size, 0);
  other.grid.origin.x() += 1;
  EXPECT_THROW(w.add_pair(other), std::logic_error);
  EXPECT_THAT(message_of<InputError>([&] { w.set_output_fields({"strain_devv"}); }), HasSubstr("strain_dev"));
  w.add_pair(sample::pair(size, 0));
  EXPECT_THROW(w.finish(), std::logic_error);  // stage piv was not ended
  w.end_stage("piv", nullptr);
  EXPECT_THROW(w.add_pair(sample::pair(size, 1)), std::logic_error);
  EXPECT_THROW(w.pair(1), std::logic_error);
}

}  // namespace
}  // namespace pivnp::io
