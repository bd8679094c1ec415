#include "trajectory/foreign/text_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "core/error.hpp"

namespace twincell {

std::ifstream open_input(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code error;
  if (!std::filesystem::exists(file, error)) throw InputError({name, 0, 0, ""}, "the file does not exist.");
  if (std::filesystem::is_directory(file, error))
    throw InputError({name, 0, 0, ""}, "this is a folder; a file is needed.");
  if (!std::filesystem::is_regular_file(file, error))
    throw InputError({name, 0, 0, ""}, "this is not a regular file.");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError({name, 0, 0, ""}, "the file cannot be read.");
  return stream;
}

std::int64_t size_of_input(const std::filesystem::path& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  return error ? 0 : static_cast<std::int64_t>(size);
}

LineReader::LineReader(const std::filesystem::path& file)
    : file_(file), stream_(open_input(file)), size_(size_of_input(file)) {}

bool LineReader::next() {
  if (!std::getline(stream_, line_)) return false;
  ++number_;
  done_ += static_cast<std::int64_t>(line_.size()) + 1;
  if (line_.size() > kLongestLine)
    throw InputError({file_.string(), number_, 0, ""},
                     fmt::format("the line has {} bytes; at most {} are read.", line_.size(), kLongestLine));
  return true;
}

void split_words(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  for (std::size_t at = 0; at < line.size();) {
    at = line.find_first_not_of(" \t\r", at);
    if (at == std::string_view::npos) return;
    const std::size_t end = std::min(line.find_first_of(" \t\r", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
}

TextOutput::TextOutput(const std::filesystem::path& file)
    : file_(file), stream_(file, std::ios::binary | std::ios::trunc) {
  if (!stream_)
    throw RunError(fmt::format("{}: cannot be written: {}.", file.string(), std::strerror(errno)));
}

void TextOutput::flush() {
  stream_.write(text_.data(), static_cast<std::streamsize>(text_.size()));
  text_.clear();
  if (!stream_)
    throw RunError(fmt::format("{}: cannot be written: {}.", file_.string(), std::strerror(errno)));
}

void TextOutput::flush_if_large() {
  constexpr std::size_t kLarge = std::size_t{1} << 20;
  if (text_.size() > kLarge) flush();
}

void TextOutput::close() {
  flush();
  stream_.close();
  if (!stream_)
    throw RunError(fmt::format("{}: cannot be written: {}.", file_.string(), std::strerror(errno)));
}

}  // namespace twincell
