#include "imaging/stack/formats/raw_pixels.hpp"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "imaging/stack/formats/byte_file.hpp"

namespace twincell::imaging::frames {

namespace {

static_assert(std::endian::native == std::endian::little, "16-bit pixels are copied as stored in the file");

void swap_bytes(cv::Mat& words) {
  for (int y = 0; y < words.rows; ++y) {
    auto* row = words.ptr<std::uint16_t>(y);
    for (int i = 0; i < words.cols * words.channels(); ++i)
      row[i] = static_cast<std::uint16_t>(row[i] << 8 | row[i] >> 8);
  }
}

}  // namespace

void unpack_bits(const std::uint8_t* from, int bits, std::size_t n, std::uint16_t* to) {
  const std::uint32_t mask = (1U << bits) - 1;
  std::uint32_t held = 0;
  int have = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (; have < bits; have += 8) held = held << 8 | *from++;
    have -= bits;
    to[i] = static_cast<std::uint16_t>(held >> have & mask);
  }
}

cv::Mat unpack(const std::uint8_t* raw, const RawLayout& layout) {
  const int channels = layout.stored_bits == 24 || layout.stored_bits == 48 ? 3 : 1;
  const bool bytes = layout.stored_bits == 8 || layout.stored_bits == 24;
  cv::Mat frame(layout.height, layout.width, CV_MAKETYPE(bytes ? CV_8U : CV_16U, channels));
  if (bytes || layout.stored_bits == 16 || layout.stored_bits == 48) {
    std::memcpy(frame.data, raw, layout.bytes());
    if (!bytes && layout.big_first) swap_bytes(frame);
    if (layout.shift > 0)
      for (int y = 0; y < frame.rows; ++y)
        for (int x = 0; x < frame.cols; ++x) frame.at<std::uint16_t>(y, x) >>= layout.shift;
  } else {
    unpack_bits(raw, layout.stored_bits, frame.total(), frame.ptr<std::uint16_t>());
  }
  if (channels == 3) cv::cvtColor(frame, frame, cv::COLOR_BGR2GRAY);
  if (layout.bottom_up || layout.mirrored)
    cv::flip(frame, frame, layout.bottom_up && layout.mirrored ? -1 : layout.bottom_up ? 0 : 1);
  return frame;
}

cv::Mat grey(const cv::Mat& picture, const std::filesystem::path& file) {
  cv::Mat one;
  if (picture.channels() == 1) {
    one = picture;
  } else if (picture.channels() == 3) {
    cv::cvtColor(picture, one, cv::COLOR_BGR2GRAY);
  } else if (picture.channels() == 4) {
    cv::cvtColor(picture, one, cv::COLOR_BGRA2GRAY);
  } else {
    refuse(file, fmt::format("has {} channels; 1, 3 or 4 can be read.", picture.channels()));
  }
  if (one.depth() == CV_8U || one.depth() == CV_16U || one.depth() == CV_32F) return one;
  cv::Mat real;
  one.convertTo(real, CV_32F);
  return real;
}

cv::Mat oriented(const cv::Mat& picture, std::uint64_t orientation) {
  constexpr int kTopToBottom = 0, kLeftToRight = 1, kBoth = -1;
  if (orientation < 2 || orientation > 8) return picture;
  cv::Mat shown;
  if (orientation >= 5)
    cv::transpose(picture, shown);
  else
    shown = picture;
  switch (orientation) {
    case 2:
    case 6:
      cv::flip(shown, shown, kLeftToRight);
      break;
    case 3:
    case 7:
      cv::flip(shown, shown, kBoth);
      break;
    case 4:
    case 8:
      cv::flip(shown, shown, kTopToBottom);
      break;
    default:
      break;
  }
  return shown;
}

std::string orientation_note(std::uint64_t orientation) {
  constexpr std::array<const char*, 9> kDone = {"",
                                                "",
                                                "mirrored left to right",
                                                "turned by 180 degrees",
                                                "mirrored top to bottom",
                                                "transposed",
                                                "turned by 90 degrees clockwise",
                                                "transposed about the other diagonal",
                                                "turned by 90 degrees counter-clockwise"};
  if (orientation < 2 || orientation > 8) return {};
  return fmt::format(
      "the file states orientation {}: the stored picture is {}, as viewers show it; x and y are those of "
      "the picture that is shown.",
      orientation, kDone[orientation]);
}

}  // namespace twincell::imaging::frames
