#pragma once
/// \file
/// Unpacks pixels as cameras store them: 8 or 16 bits, packed bits, bottom row first.

#include <cstdint>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

namespace twincell::imaging::frames {

/// Storage layout of one uncompressed frame.
struct RawLayout {
  int width = 0, height = 0;
  int stored_bits = 8;  ///< 8; 16; 9 .. 15 (packed without gaps, most significant bit first); 24 or 48 (BGR)
  int shift = 0;        ///< 16 bit: the value is shifted up by this many bits
  bool big_first = false;  ///< 16 and 48 bit: most significant byte first
  bool bottom_up = false;  ///< first row in the file is the bottom row
  bool mirrored = false;   ///< first pixel of a row is the rightmost

  /// Bytes of one frame.
  [[nodiscard]] std::uint64_t bytes() const {
    return (static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) *
                static_cast<std::uint64_t>(stored_bits) +
            7) /
           8;
  }
};

/// Frame of type CV_8U or CV_16U from layout.bytes() bytes.
cv::Mat unpack(const std::uint8_t* raw, const RawLayout& layout);

/// Unpacks `n` values of `bits` <= 16 bits each, packed most significant bit first.
void unpack_bits(const std::uint8_t* from, int bits, std::size_t n, std::uint16_t* to);

/// Converts a picture to one grey channel of type CV_8U, CV_16U or CV_32F. These depths are kept, others
/// become CV_32F. Colour is read as BGR (BT.601).
/// \throws InputError naming `file` unless there are 1, 3 or 4 channels
cv::Mat grey(const cv::Mat& picture, const std::filesystem::path& file);

/// The picture as viewers show it. Cameras and editors that are turned store the pixels as they are, and
/// beside them how a viewer must turn and mirror them. \param orientation tag 274 of TIFF and EXIF, 1 .. 8
/// (TIFF 6.0, section 8): 1 as stored, 2 mirrored left to right, 3 turned by 180 degrees, 4 mirrored top to
/// bottom, 5 transposed, 6 to be turned clockwise, 7 transposed about the other diagonal, 8 to be turned
/// counter-clockwise; others as 1
cv::Mat oriented(const cv::Mat& picture, std::uint64_t orientation);

/// Says what oriented() does; empty if nothing.
std::string orientation_note(std::uint64_t orientation);

}  // namespace twincell::imaging::frames
