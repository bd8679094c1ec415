#include "imaging/camera/movie.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <opencv2/imgproc.hpp>

#include "core/error.hpp"
#include "imaging/codecs/codecs.hpp"
#include "imaging/stack/opencv_errors.hpp"

namespace twincell::imaging {

namespace {

/// Appends a box that players skip ("free" of MP4, "JUNK" of AVI). The box ends with kFilmMark, which
/// identifies a film written by this program.
void sign(const std::filesystem::path& film) {
  const std::string mark = Product::kFilmMark;
  const auto size = static_cast<std::uint32_t>(mark.size());
  const auto bytes = [](std::uint32_t n, bool big) {
    std::string four;
    for (int k = 0; k < 4; ++k) four += static_cast<char>(n >> (big ? 24 - 8 * k : 8 * k) & 255U);
    return four;
  };
  std::ofstream out(film, std::ios::binary | std::ios::app);
  out << (film.extension() == ".avi" ? "JUNK" + bytes(size, false) : bytes(size + 8, true) + "free") << mark;
  out.close();
  if (!out) throw RunError(film.string() + ": cannot be written.");
}

}  // namespace

void require_frame_rate(double frames_per_second) {
  require_range(Where{.file = {}, .key = "--fps"}, frames_per_second, 0.01, 1000);
}

Movie::Movie(const std::filesystem::path& file, cv::Size size, double rate)
    : place_(file, Product::film()), size_((size.width + 1) / 2 * 2, (size.height + 1) / 2 * 2) {
  quiet_opencv();
  require_frame_rate(rate);
  const std::string kind = file.extension().string();
  if (kind != ".mp4" && kind != ".avi")
    throw ConfigError(Where{.file = {}, .key = "--movie"},
                      fmt::format("is '{}'; films are written as .mp4 or .avi.", file.string()));
  const std::vector<std::string> kinds =
      kind == ".avi" ? std::vector<std::string>{"MJPG"} : std::vector<std::string>{"avc1", "mp4v"};
  for (const std::string& codec : kinds) {
    writer_ = codecs().create_film(place_.part().string(), codec, rate, size_);
    if (writer_) return;
  }
  throw RunError(file.string() + ": this build of OpenCV cannot write films of this format.");
}

Movie::~Movie() = default;

void Movie::add(const cv::Mat& frame, int bits) {
  cv::Mat shown = frame, colour;
  if (bits > 8) frame.convertTo(shown, CV_8U, std::ldexp(1.0, 8 - bits));
  if (shown.size() != size_)
    cv::copyMakeBorder(shown, shown, 0, size_.height - shown.rows, 0, size_.width - shown.cols,
                       cv::BORDER_REPLICATE);
  if (shown.channels() == 1)
    cv::cvtColor(shown, colour, cv::COLOR_GRAY2BGR);
  else
    colour = shown;
  writer_->write(colour);
  ++frames_;
}

void Movie::commit() {
  writer_.reset();
  std::error_code error;
  if (std::filesystem::file_size(place_.part(), error) == 0 || error)
    throw RunError(place_.final().string() + ": cannot be written.");
  // OpenCV does not report a full disk, so the frames that can be read back are counted.
  const auto back = codecs().open_film(place_.part().string(), false);
  std::size_t kept = 0;
  while (back && kept <= frames_ && back->skip()) ++kept;
  if (kept != frames_)
    throw RunError(fmt::format("{}: {} of {} frames could be written; is the disk full?",
                               place_.final().string(), kept, frames_));
  sign(place_.part());
  place_.commit();
}

}  // namespace twincell::imaging
