#include "pivnp/io/records/table_file.hpp"

#include "pivnp/core/version.hpp"
#include "pivnp/io/hdf5/hdf5.hpp"

namespace pivnp::io {

void write_tables(const std::filesystem::path& file, const std::vector<NamedTable>& tables) {
  h5::OutputFile out(file);
  out.attribute("/", "program", "pivnp " + build_info().version + " (" + build_info().commit + ")");
  for (const NamedTable& table : tables) {
    const std::string group = "/" + table.name;
    out.group(group);
    for (const auto& [name, text] : table.attributes) out.attribute(group, name, text);
    for (const TableColumn& column : table.columns) {
      const std::string path = group + "/" + column.name;
      if (!column.texts.empty()) out.write_texts(path, column.texts);
      else out.write(path, column.numbers, column.unit, h5::Packing::plain);
    }
  }
  out.commit();
}

}  // namespace pivnp::io
