#pragma once
/// \file
/// Decodes videos with the program ffmpeg, if it is installed. Unlike OpenCV, it keeps more than 8 bits.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging::frames {

/// Properties of the first video stream of a file, as ffprobe reports them.
struct VideoFacts {
  int width = 0, height = 0;
  std::string pixels;  ///< ffmpeg's name of the pixel format: "gray16le"
  int bits = 8;        ///< per sample
  double frame_rate_hz = 0;
};

/// Containers that ffmpeg may open; each is a single file. Playlists (HLS, concat, DASH) and lists of
/// pictures are excluded, since they open other files.
inline constexpr const char* kContainers = "avi,mov,matroska,yuv4mpegpipe,mpegts,mpeg,asf,flv,ogg";

/// Name of a file for ffmpeg's command line. The prefix "file:" prevents a name with a colon or a leading
/// dash from being read as a protocol or an option.
std::string ffmpeg_name(const std::filesystem::path& file);

/// True if ffmpeg and ffprobe can be run.
bool ffmpeg_is_installed();

/// Properties of a video; absent if ffprobe finds no video in the file.
std::optional<VideoFacts> probe_video(const std::filesystem::path& file);

/// Number of frames of the first video stream. ffprobe counts the packets of the whole file without decoding
/// them, since the number in a header may be wrong. Absent if ffprobe fails.
std::optional<std::size_t> count_frames(const std::filesystem::path& file);

/// Opens a video: all frames, grey, at the bit depth of the file. Rejects files that ffmpeg finds damaged.
std::unique_ptr<FrameSource> open_ffmpeg(const std::filesystem::path& file, const VideoFacts& facts);

}  // namespace twincell::imaging::frames
