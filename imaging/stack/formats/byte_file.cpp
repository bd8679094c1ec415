#include "imaging/stack/formats/byte_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>

#include "core/error.hpp"

namespace twincell::imaging::frames {

void refuse(const std::filesystem::path& file, const std::string& complaint) {
  throw InputError(Where{.file = file.string(), .key = {}}, complaint);
}

std::string in_quotes(std::string_view text) {
  std::string plain(text.substr(0, 120));
  for (char& c : plain)
    if (c < ' ' || c > '~') c = '?';
  return "'" + plain + (text.size() > 120 ? "...'" : "'");
}

std::uint64_t number_at(const std::uint8_t* b, std::size_t n, bool big_first) {
  std::uint64_t v = 0;
  for (std::size_t i = 0; i < n; ++i) v |= std::uint64_t{b[big_first ? n - 1 - i : i]} << (8 * i);
  return v;
}

ByteFile::ByteFile(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code error;
  const auto status = std::filesystem::status(file_, error);
  if (!std::filesystem::exists(status))
    refuse(file_.string().find('*') == std::string::npos
               ? "does not exist."
               : "does not exist; name the folder of the pictures, not a pattern.");
  if (std::filesystem::is_directory(status)) refuse("is a folder, not a file of frames.");
  if (!std::filesystem::is_regular_file(status)) refuse("is not a regular file.");
  in_.open(file_, std::ios::binary);
  if (!in_) refuse("cannot be opened for reading.");
  size_ = std::filesystem::file_size(file_, error);
  if (error) refuse("has no readable size: " + error.message() + ".");
}

void ByteFile::require(std::uint64_t at, std::uint64_t n, const std::string& what) const {
  if (at <= size_ && n <= size_ - at) return;
  if (n > UINT64_MAX - at) refuse(fmt::format("is damaged: {} would end beyond byte 2^64.", what));
  refuse(fmt::format("is truncated: {} ends at byte {}, the file at byte {}.", what, at + n, size_));
}

void ByteFile::read(std::uint64_t at, std::uint64_t n, void* to, const std::string& what) const {
  require(at, n, what);
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(at));
  in_.read(static_cast<char*>(to), static_cast<std::streamsize>(n));
  if (static_cast<std::uint64_t>(in_.gcount()) != n)
    refuse(fmt::format("cannot be read at the position of {}.", what));
}

std::vector<std::uint8_t> ByteFile::bytes(std::uint64_t at, std::uint64_t n, const std::string& what) const {
  require(at, n, what);  // before memory is allocated
  std::vector<std::uint8_t> b(n);
  read(at, n, b.data(), what);
  return b;
}

std::uint64_t ByteFile::number(std::uint64_t at, std::size_t n, const std::string& what,
                               bool big_first) const {
  std::array<std::uint8_t, 8> b{};
  read(at, n, b.data(), what);
  return number_at(b.data(), n, big_first);
}

double ByteFile::f64(std::uint64_t at, const std::string& what) const {
  return std::bit_cast<double>(number(at, 8, what));
}

void require_plausible_size(const std::filesystem::path& file, std::uint64_t width, std::uint64_t height,
                            std::uint64_t bytes_per_pixel, std::uint64_t file_size) {
  constexpr std::uint64_t longest = 1U << 20, most = 1U << 28, always = 64U << 20, compressed = 2000;
  if (width == 0 || height == 0 || width > longest || height > longest || width * height > most)
    refuse(file, fmt::format("states frames of {} x {} pixels; sides of 1 to {} and at most {} pixels can "
                             "be read.",
                             width, height, longest, most));
  const std::uint64_t needed = width * height * bytes_per_pixel;
  if (needed > always && needed / compressed > file_size)
    refuse(file, fmt::format("states frames of {} x {} pixels, which {} bytes of file cannot hold.", width,
                             height, file_size));
}

}  // namespace twincell::imaging::frames
