// Videos. OpenCV opens most of them, but always returns 8 bits and rescales the values of grey videos. Grey
// videos and videos of more than 8 bits are therefore read with the program ffmpeg, if it is installed.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <opencv2/videoio.hpp>

#include "core/cancellation.hpp"
#include "imaging/codecs/codecs.hpp"
#include "imaging/stack/formats/byte_file.hpp"
#include "imaging/stack/formats/ffmpeg_pipe.hpp"
#include "imaging/stack/formats/raw_pixels.hpp"
#include "imaging/stack/formats/reader.hpp"
#include "imaging/stack/formats/size_guard.hpp"
#include "imaging/stack/opencv_errors.hpp"

namespace twincell::imaging::frames {

namespace {

namespace fs = std::filesystem;

class Video final : public FrameSource {
 public:
  explicit Video(const fs::path& file) : file_(file) {
    quiet_opencv();
    // OpenCV passes these options to the libraries that the program ffmpeg also uses.
    static const int limited =
        setenv("OPENCV_FFMPEG_CAPTURE_OPTIONS",
               fmt::format("protocol_whitelist;file,pipe|format_whitelist;{}", kContainers).c_str(), 1);
    (void)limited;
    try {
      film_ = codecs().open_film(ffmpeg_name(file), true);
    } catch (const cv::Exception&) {  // is_open() is then false
    }
    if (!film_) return;
    info_.format = "video read by OpenCV";
    info_.width = static_cast<int>(film_->property(cv::CAP_PROP_FRAME_WIDTH));
    info_.height = static_cast<int>(film_->property(cv::CAP_PROP_FRAME_HEIGHT));
    info_.bits = 8;
    if (const double rate = film_->property(cv::CAP_PROP_FPS); rate > 0 && rate < 1e9)
      info_.frame_rate_hz = rate;
    info_.playback = true;
    stated_ = static_cast<std::size_t>(std::max(0.0, film_->property(cv::CAP_PROP_FRAME_COUNT)));
    info_.notes.push_back(fmt::format(
        "a video is read with 8 bits whatever its bit depth, and its grey values are not those the camera "
        "measured{}",
        ffmpeg_is_installed() ? "." : "; with ffmpeg installed, grey and deeper videos keep their values."));
  }
  [[nodiscard]] bool is_open() const { return film_ != nullptr; }

  bool next(cv::Mat& frame) override {
    cv::Mat picture;
    if (!film_->read(picture) || picture.empty()) {
      if (read_ == 0) refuse(file_, "holds no frame that can be decoded.");
      // The stated number may be an estimate, but a deficit of more than 5 % means damage.
      if (static_cast<double>(read_) < 0.95 * static_cast<double>(stated_) - 2)
        refuse(file_, fmt::format("is truncated or damaged: it announces {} frames, of which {} can be read.",
                                  stated_, read_));
      return false;
    }
    ++read_;
    frame = grey(picture, file_);
    guard_.check(frame, current());
    return true;
  }
  // Streamed containers state no number of frames, others an estimate from the duration. The frames are
  // therefore counted, on the first call.
  [[nodiscard]] std::size_t announced() const override {
    if (!counted_) counted_ = ffmpeg_is_installed() ? count_frames(file_) : std::nullopt;
    if (!counted_) counted_ = grabbed();
    return *counted_;
  }
  [[nodiscard]] std::string current() const override {
    return fmt::format("{}, frame {}", file_.string(), read_ > 0 ? read_ - 1 : 0);
  }
  [[nodiscard]] StackInfo info() const override { return info_; }

 private:
  /// Number of frames that can be read, found by reading them.
  [[nodiscard]] std::size_t grabbed() const {
    std::size_t n = 0;
    const auto again = codecs().open_film(ffmpeg_name(file_), true);
    for (; again && again->skip(); ++n) throw_if_cancelled();
    return n;
  }

  fs::path file_;
  std::unique_ptr<FilmReader> film_;
  std::size_t stated_ = 0, read_ = 0;
  mutable std::optional<std::size_t> counted_;
  SizeGuard guard_;
  StackInfo info_;
};

std::unique_ptr<FrameSource> open_video(const fs::path& file, const std::string&) {
  if (ffmpeg_is_installed())
    if (const auto facts = probe_video(file); facts && (facts->bits > 8 || facts->pixels.starts_with("gray")))
      return open_ffmpeg(file, *facts);
  if (auto video = std::make_unique<Video>(file); video->is_open()) return video;
  if (!ffmpeg_is_installed())
    refuse(file,
           "cannot be decoded as a video by OpenCV; ffmpeg, which reads more formats, is not installed.");
  if (const auto facts = probe_video(file)) return open_ffmpeg(file, *facts);
  refuse(file, "cannot be decoded as a video, neither by OpenCV nor by ffmpeg.");
}

// Text is not a video, although ffmpeg would render it as one.
bool is_text(const Head& head) {
  return std::all_of(head.bytes.begin(), head.bytes.end(),
                     [](std::uint8_t b) { return b >= 32 || (b >= 9 && b <= 13) || b == 27; });
}

}  // namespace

extern const Reader video_reader;
const Reader video_reader = {
    .extensions = ".avi .mp4 .mkv .mov .m4v .webm .y4m",
    .owns = [](const Head& head) { return !is_text(head) || head.starts_with("YUV4MPEG2"); },
    .open = open_video};

}  // namespace twincell::imaging::frames
