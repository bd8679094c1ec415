#include "imaging/track/overlay.hpp"

#include <algorithm>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "imaging/codecs/codecs.hpp"

namespace twincell::imaging {

cv::Mat3b draw_overlay(const cv::Mat& grey, const std::vector<Detection>& beads, int enlarge) {
  // The largest grey level of the frame is drawn white, so that 10- and 12-bit frames are not black.
  double top = 0;
  cv::minMaxLoc(grey, nullptr, &top);
  cv::Mat1b byte;
  grey.convertTo(byte, CV_8U, grey.depth() == CV_8U || top <= 0 ? 1.0 : 255 / top);
  cv::Mat3b picture;
  cv::cvtColor(byte, picture, cv::COLOR_GRAY2BGR);
  cv::resize(picture, picture, cv::Size(), enlarge, enlarge, cv::INTER_LINEAR);
  constexpr int shift = 4, one = 1 << shift;  // OpenCV draws at sixteenths of a pixel
  auto enlarged = [&](double v) { return cvRound((enlarge * (v + 0.5) - 0.5) * one); };
  for (const Detection& b : beads) {
    const cv::Scalar colour = b.tracer ? cv::Scalar(255, 0, 255)
                              : b.edge ? cv::Scalar(0, 140, 255)
                                       : cv::Scalar(60, 200, 0);
    const cv::Point centre(enlarged(b.x), enlarged(b.y));
    cv::circle(picture, centre, cvRound(enlarge * b.radius * one), colour, 1, cv::LINE_AA, shift);
    cv::circle(picture, centre, one, colour, cv::FILLED, cv::LINE_AA, shift);
  }
  return picture;
}

namespace {

constexpr std::size_t kEndOfPngHeader = 33;

/// The chunk "Software: twincell" of a PNG (ISO/IEC 15948, 11.3.4.3). It identifies earlier pictures written
/// by this program.
std::string software_chunk() {
  const std::string body("tEXtSoftware\0twincell", 21);
  std::uint32_t crc = 0xffffffffU;  // ISO 3309, as in annex D of PNG
  for (const char c : body) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? 0xedb88320U ^ (crc >> 1) : crc >> 1;
  }
  const auto four = [](std::uint32_t n) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(n >> shift & 255U);
    return bytes;
  };
  return four(static_cast<std::uint32_t>(body.size() - 4)) + body + four(crc ^ 0xffffffffU);
}

}  // namespace

void write_png(const std::filesystem::path& png, const cv::Mat& picture) {
  constexpr int kCompression = 9;  // the default of OpenCV is the fastest, with twice the bytes
  const std::vector<unsigned char> bytes =
      codecs().encode(".png", picture, {cv::IMWRITE_PNG_COMPRESSION, kCompression});
  if (bytes.empty()) throw RunError(png.string() + ": the picture cannot be encoded as PNG.");
  std::string file(bytes.begin(), bytes.end());
  file.insert(kEndOfPngHeader, software_chunk());
  write_text_file(png, file, Product::picture());
}

void write_overlay(const std::filesystem::path& png, const cv::Mat& grey,
                   const std::vector<Detection>& beads) {
  write_png(png, draw_overlay(grey, beads, std::clamp(1600 / std::max(grey.cols, 1), 1, 4)));
}

}  // namespace twincell::imaging
