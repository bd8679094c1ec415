#pragma once
/// \file
/// Videos through the program ffmpeg, which keeps more than 8 bits; where it is installed.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "imaging/stack/frame_source.hpp"

namespace twincell::frames {

/// What ffprobe says of the first video stream of a file.
struct VideoFacts {
  int width = 0, height = 0;
  std::string pixels;  ///< ffmpeg's name of the pixel format: "gray16le"
  int bits = 8;        ///< per sample
  double frame_rate_hz = 0;
};

/// Containers that ffmpeg may open: each is one file. Playlists (HLS, concat, DASH) and lists of pictures,
/// which open other files, are none of them.
inline constexpr const char* kContainers = "avi,mov,matroska,yuv4mpegpipe,mpegts,mpeg,asf,flv,ogg";

/// A file as ffmpeg is told it: "file:" keeps a name with a colon or a leading dash from being taken for a
/// protocol or an option.
std::string ffmpeg_name(const std::filesystem::path& file);

/// True if ffmpeg and ffprobe can be run.
bool ffmpeg_is_installed();

/// Absent if ffprobe finds no video in the file.
std::optional<VideoFacts> probe_video(const std::filesystem::path& file);

/// Frames of the first video stream, counted through the whole file without decoding them: no header is
/// believed. Absent if ffprobe cannot.
std::optional<std::size_t> count_frames(const std::filesystem::path& file);

/// All frames, grey, at the depth of the file. A file that ffmpeg finds damaged is refused.
std::unique_ptr<FrameSource> open_ffmpeg(const std::filesystem::path& file, const VideoFacts& facts);

}  // namespace twincell::frames
