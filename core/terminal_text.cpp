#include "core/terminal_text.hpp"

#include <algorithm>
#include <sstream>

namespace twincell {

namespace {

bool begins_character(char byte) {
  return (byte & 0xC0) != 0x80;  // the other bytes of a UTF-8 character take no column
}

/// Where to break a line: the last space within `width` columns, or else the next one; npos if there is none.
/// \param from no break is made before this position
std::size_t break_of(const std::string& line, std::size_t width, std::size_t from) {
  std::size_t columns = 0, found = std::string::npos;
  for (std::size_t k = 0; k < line.size(); ++k) {
    if (columns > width && found != std::string::npos) break;
    if (line[k] == ' ' && k >= from) found = k;
    columns += begins_character(line[k]) ? 1 : 0;
    if (columns > width && found != std::string::npos) break;
  }
  return found;
}

/// Position of the last column, which two spaces or more separate from the one before.
std::size_t last_column(const std::string& line) {
  const std::size_t gap = line.rfind("  ");
  return gap == std::string::npos ? 0 : line.find_first_not_of(' ', gap);
}

}  // namespace

std::size_t columns_of(const std::string& line) {
  return static_cast<std::size_t>(std::count_if(line.begin(), line.end(), begins_character));
}

std::string fold_line(const std::string& line, std::size_t width, const std::string& later) {
  std::string out, rest = line;
  std::size_t from = std::min(line.find_first_not_of(' '), line.size());
  while (columns_of(rest) > width) {
    const std::size_t at = break_of(rest, width, from);
    const std::size_t next = at == std::string::npos ? at : rest.find_first_not_of(' ', at);
    if (next == std::string::npos) break;
    out += rest.substr(0, rest.find_last_not_of(' ', at) + 1) + "\n";
    rest = later + rest.substr(next);
    from = later.size();
  }
  return out + rest + "\n";
}

std::string fit_columns(const std::string& text, std::size_t width) {
  std::istringstream lines(text);
  std::string out, line;
  while (std::getline(lines, line)) {
    const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
    std::size_t hang = std::max(begin, last_column(line));
    if (hang <= begin || hang > width / 2) hang = begin + 4;
    out += fold_line(line, width, std::string(hang, ' '));
  }
  return out;
}

}  // namespace twincell
