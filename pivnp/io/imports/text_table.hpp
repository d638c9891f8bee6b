// What the readers of text tables share: lines with their numbers, cells, and numbers that are not believed blindly.
// Private to this folder's sources.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace pivnp::io {

/// A text file line by line. Throws InputError where it cannot be read.
class TextLines {
 public:
  explicit TextLines(std::filesystem::path file);
  TextLines(const TextLines&) = delete;
  TextLines& operator=(const TextLines&) = delete;
  /// False at the end. Neither the line's end nor a byte order mark is part of a line.
  bool next(std::string_view& line);
  const std::filesystem::path& file() const { return file_; }
  int number() const { return number_; }  // of the line that was given last, from 1
  /// "FILE:LINE: ", of that line or another one.
  std::string at() const { return at(number_); }
  std::string at(int line) const;
  /// A cell's number; NaN where the cell is empty or says so. Throws InputError with the line, `column` and what was
  /// found; infinite numbers, and those beyond single precision, are refused too.
  double value(std::string_view cell, std::string_view column) const;

 private:
  std::filesystem::path file_;
  std::string text_;
  std::string_view rest_;
  int number_ = 0;
};

/// The cells of a line without blanks and quotation marks around them. A blank as separator stands for any number of
/// blanks and tabs.
std::vector<std::string_view> cells_of(std::string_view line, char separator);

/// What separates the cells of a line: the first of ';', tab and ',' that it holds, else blanks.
char separator_of(std::string_view line);

/// A column's name as it is looked for: small letters, no blanks, no quotation marks.
std::string column_name(std::string_view text);

/// The first line that is neither empty nor a remark (#). Throws InputError where there is none.
std::string_view line_of_names(TextLines& lines);
/// The names of the columns in a line.
std::vector<std::string> header_of(std::string_view line, char separator);
/// The cells of the line that was given last. Throws InputError with the line if there are not `columns` of them.
std::vector<std::string_view> row_of(const TextLines& lines, std::string_view line, char separator, std::size_t columns);

/// Place of the first of `names` among the columns; -1 if none is there.
int column_of(const std::vector<std::string>& header, const std::vector<const char*>& names);

}  // namespace pivnp::io
