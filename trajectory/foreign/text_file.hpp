#pragma once
/// \file
/// Lines of a text file that is read, and text of a file that is written, in bounded memory.

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace twincell {

/// Opens a file for reading.
/// \throws InputError if it is missing, a folder, not a regular file, or unreadable
std::ifstream open_input(const std::filesystem::path& file);
/// Bytes of the file.
std::int64_t size_of_input(const std::filesystem::path& file);

/// The lines of a text file, one at a time. A line may have at most kLongestLine bytes.
class LineReader {
 public:
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;

  /// \throws InputError as open_input
  explicit LineReader(const std::filesystem::path& file);
  /// Reads the next line without its end.
  /// \returns false at the end of the file
  /// \throws InputError for a line that is too long
  bool next();
  [[nodiscard]] std::string& line() { return line_; }
  [[nodiscard]] long number() const { return number_; }  ///< of the line, from 1
  [[nodiscard]] std::int64_t size() const { return size_; }
  [[nodiscard]] std::int64_t done() const { return done_; }

 private:
  std::filesystem::path file_;
  std::ifstream stream_;
  std::string line_;
  long number_ = 0;
  std::int64_t size_, done_ = 0;
};

/// Splits a line at white space.
void split_words(std::string_view line, std::vector<std::string_view>& words);

/// Text of a file, written in large pieces.
class TextOutput {
 public:
  /// \throws RunError if the file cannot be opened
  explicit TextOutput(const std::filesystem::path& file);
  /// Text to which the caller appends.
  [[nodiscard]] std::string& text() { return text_; }
  /// Writes the text if it is large.
  /// \throws RunError naming the file if it cannot be written
  void flush_if_large();
  /// Writes the rest and closes.
  /// \throws RunError as flush_if_large
  void close();

 private:
  void flush();
  std::filesystem::path file_;
  std::ofstream stream_;
  std::string text_;
};

}  // namespace twincell
