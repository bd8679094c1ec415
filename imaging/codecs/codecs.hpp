#pragma once
/// \file
/// OpenCV's codecs of pictures and films, loaded when the first of them is used.
///
/// They depend on some 180 shared libraries. A program that links them spends four fifths of the time of its
/// start on loading these, whether it reads a picture or not. Everything here therefore reaches them through
/// a module, libtwincell_codecs.so, and nothing links them (tests/architecture).

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace twincell::imaging {

/// A film that is read frame by frame (cv::VideoCapture).
class FilmReader {
 public:
  virtual ~FilmReader() = default;
  /// The next frame; false at the end or where it cannot be decoded.
  virtual bool read(cv::Mat& frame) = 0;
  /// Goes on by a frame without decoding it; false at the end.
  virtual bool skip() = 0;
  /// A property by its number in OpenCV, cv::CAP_PROP_FRAME_COUNT and so on.
  [[nodiscard]] virtual double property(int number) const = 0;
};

/// A film that is written frame by frame (cv::VideoWriter); its destructor closes it.
class FilmWriter {
 public:
  virtual ~FilmWriter() = default;
  /// Appends a frame, 8-bit, of the size of the film.
  virtual void write(const cv::Mat& frame) = 0;
};

/// The codecs.
class Codecs {
 public:
  virtual ~Codecs() = default;
  /// The picture, as it is stored (cv::imdecode); empty if it cannot be decoded.
  /// \throws cv::Exception
  [[nodiscard]] virtual cv::Mat decode(const std::vector<unsigned char>& bytes) const = 0;
  /// Bytes of `picture` as a file of this ending, ".png" (cv::imencode); empty if that fails.
  /// \param settings pairs of a property, cv::IMWRITE_PNG_COMPRESSION and so on, and its value
  [[nodiscard]] virtual std::vector<unsigned char> encode(const std::string& ending, const cv::Mat& picture,
                                                          const std::vector<int>& settings) const = 0;
  /// The film of this name, read by FFmpeg where `only_ffmpeg`; null if it cannot be opened.
  [[nodiscard]] virtual std::unique_ptr<FilmReader> open_film(const std::string& name,
                                                              bool only_ffmpeg) const = 0;
  /// A new film of colour frames.
  /// \param codec four letters: "MJPG"
  /// \param rate frames per second
  /// \returns null if this build of OpenCV has no such codec
  [[nodiscard]] virtual std::unique_ptr<FilmWriter> create_film(const std::string& name,
                                                                const std::string& codec, double rate,
                                                                cv::Size size) const = 0;
};

/// The codecs of the module, which the first call loads.
/// \throws RunError with the reason if the module cannot be loaded
const Codecs& codecs();

}  // namespace twincell::imaging
