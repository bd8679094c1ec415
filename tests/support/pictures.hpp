#pragma once
/// \file
/// Single pictures in files. They go through the codecs of the library (imaging/codecs), which are loaded
/// when they are used: a test program that links OpenCV's codecs takes five times as long to start.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "imaging/codecs/codecs.hpp"
#include "tests/support/file_bytes.hpp"

namespace twincell {

/// The picture as it is stored; empty if it cannot be read.
inline cv::Mat read_picture(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(in),
                                         std::istreambuf_iterator<char>()};
  return bytes.empty() ? cv::Mat() : imaging::codecs().decode(bytes);
}

/// Writes a picture in the format of the file's ending.
inline void write_picture(const std::filesystem::path& file, const cv::Mat& picture) {
  const std::vector<unsigned char> bytes = imaging::codecs().encode(file.extension().string(), picture, {});
  ASSERT_FALSE(bytes.empty()) << file;
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  ASSERT_TRUE(out.flush()) << file;
}

}  // namespace twincell
