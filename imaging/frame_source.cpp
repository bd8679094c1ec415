#include "imaging/frame_source.hpp"

#include "imaging/frames/byte_file.hpp"
#include "imaging/frames/reader.hpp"
#include "imaging/opencv_words.hpp"

namespace twincell {

namespace fs = std::filesystem;

namespace {

struct Named {
  fs::path file;
  std::string inside;  ///< dataset within the file
};

// "file.h5:/path", unless there is a file or folder of that whole name.
Named split(const fs::path& stack) {
  std::error_code error;
  const std::string name = stack.string();
  const std::size_t colon = name.rfind(":/");
  if (colon == std::string::npos || fs::exists(stack, error)) return {stack, {}};
  return {name.substr(0, colon), name.substr(colon + 1)};
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      std::size_t ie = i, je = j;
      while (ie < a.size() && digit(a[ie])) ++ie;
      while (je < b.size() && digit(b[je])) ++je;
      while (i < ie && a[i] == '0') ++i;
      while (j < je && b[j] == '0') ++j;
      if (ie - i != je - j) return ie - i < je - j;
      const int order = a.compare(i, ie - i, b, j, je - j);
      if (order != 0) return order < 0;
      i = ie;
      j = je;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (i == a.size() && j == b.size()) return a < b;
  return i == a.size();
}

fs::path file_of_stack(const fs::path& stack) {
  return split(stack).file;
}

std::unique_ptr<FrameSource> open_frames(const fs::path& stack) {
  quiet_opencv();
  const auto [file, inside] = split(stack);
  std::error_code error;
  if (fs::is_directory(file, error)) return frames::open_folder(file);
  const frames::Head head = frames::head_of(file);
  const frames::Reader& reader = frames::reader_of(head);
  if (!inside.empty() && reader.extensions != ".h5 .hdf5")
    frames::refuse(file, "is no HDF5 file, and so has no dataset " + inside + ".");
  return reader.open(file, inside);
}

}  // namespace twincell
