#pragma once
/// \file
/// Opens stacks of frames: folders of pictures, TIFF stacks, camera files, HDF5 stacks, videos.

#include <filesystem>
#include <memory>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

/// Opens a stack: a folder (its PNG, TIFF, JPEG, BMP and PGM files in natural order, all pages of each), one
/// such file, a camera file (.cine; .mraw, .cih or .cihx; .seq; .mrf), a 3-D dataset of an HDF5 file
/// ("file.h5:/path", or the only one), or a video. The format is recognised by the content of the file; only
/// .mraw, .cih and .cihx files are recognised by name. docs/frames.md has the table.
/// \throws InputError if there is nothing to read
std::unique_ptr<FrameSource> open_frames(const std::filesystem::path& stack);

/// Whether a file is one of the pictures of a folder that open_frames() reads, by its extension: .png, .tif,
/// .tiff, .jpg, .jpeg, .bmp or .pgm, in small or capital letters.
bool has_picture_name(const std::filesystem::path& file);

/// File or folder on disk that contains a stack: "file.h5" for "file.h5:/path".
std::filesystem::path file_of_stack(const std::filesystem::path& stack);

}  // namespace twincell::imaging
