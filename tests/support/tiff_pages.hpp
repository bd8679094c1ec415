#pragma once
/// \file
/// A stack of grey pages in a TIFF file, compressed with LZW.

#include <gtest/gtest.h>
#include <tiffio.h>

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

namespace twincell {

inline void write_pages(const std::filesystem::path& file, const std::vector<cv::Mat>& pages) {
  const std::unique_ptr<TIFF, decltype(&TIFFClose)> tiff(TIFFOpen(file.c_str(), "w"), &TIFFClose);
  ASSERT_NE(tiff, nullptr) << file;
  for (const cv::Mat& page : pages) {
    TIFFSetField(tiff.get(), TIFFTAG_IMAGEWIDTH, page.cols);
    TIFFSetField(tiff.get(), TIFFTAG_IMAGELENGTH, page.rows);
    TIFFSetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, 8 * static_cast<int>(page.elemSize1()));
    TIFFSetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, page.channels());
    TIFFSetField(tiff.get(), TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff.get(), TIFFTAG_COMPRESSION, COMPRESSION_LZW);
    TIFFSetField(tiff.get(), TIFFTAG_ROWSPERSTRIP, page.rows);
    cv::Mat rows = page.clone();
    for (int y = 0; y < rows.rows; ++y)
      ASSERT_EQ(TIFFWriteScanline(tiff.get(), rows.ptr(y), static_cast<std::uint32_t>(y), 0), 1);
    ASSERT_EQ(TIFFWriteDirectory(tiff.get()), 1);
  }
}

}  // namespace twincell
