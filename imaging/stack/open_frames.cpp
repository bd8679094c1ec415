#include "imaging/stack/open_frames.hpp"

#include "imaging/stack/formats/byte_file.hpp"
#include "imaging/stack/formats/reader.hpp"
#include "imaging/stack/opencv_errors.hpp"

namespace twincell::imaging {

namespace fs = std::filesystem;

namespace {

struct Named {
  fs::path file;
  std::string inside;  ///< dataset within the file
};

// Splits "file.h5:/path", unless a file or folder with the whole name exists.
Named split(const fs::path& stack) {
  std::error_code error;
  const std::string name = stack.string();
  const std::size_t colon = name.rfind(":/");
  if (colon == std::string::npos || fs::exists(stack, error)) return {stack, {}};
  return {name.substr(0, colon), name.substr(colon + 1)};
}

}  // namespace

fs::path file_of_stack(const fs::path& stack) {
  return split(stack).file;
}

bool has_picture_name(const fs::path& file) {
  return frames::is_picture_of_folder(file);
}

std::unique_ptr<FrameSource> open_frames(const fs::path& stack) {
  quiet_opencv();
  const auto [file, inside] = split(stack);
  std::error_code error;
  if (fs::is_directory(file, error)) return frames::open_folder(file);
  const frames::Head head = frames::head_of(file);
  const frames::Reader& reader = frames::reader_of(head);
  if (!inside.empty() && reader.extensions != ".h5 .hdf5")
    frames::refuse(file, "is not an HDF5 file, and so has no dataset " + inside + ".");
  return reader.open(file, inside);
}

}  // namespace twincell::imaging
