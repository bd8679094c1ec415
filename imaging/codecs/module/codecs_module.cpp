// The module libtwincell_codecs.so: the only code that calls OpenCV's codecs.

#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "imaging/codecs/codecs.hpp"

namespace twincell::imaging {

namespace {

class Reader final : public FilmReader {
 public:
  Reader(const std::string& name, bool only_ffmpeg)
      : film_(name, only_ffmpeg ? cv::CAP_FFMPEG : cv::CAP_ANY) {}
  [[nodiscard]] bool is_open() const { return film_.isOpened(); }
  bool read(cv::Mat& frame) override { return film_.read(frame); }
  bool skip() override { return film_.grab(); }
  [[nodiscard]] double property(int number) const override { return film_.get(number); }

 private:
  cv::VideoCapture film_;
};

class Writer final : public FilmWriter {
 public:
  Writer(const std::string& name, const std::string& codec, double rate, cv::Size size)
      : film_(name, cv::VideoWriter::fourcc(codec.at(0), codec.at(1), codec.at(2), codec.at(3)), rate, size,
              true) {}
  [[nodiscard]] bool is_open() const { return film_.isOpened(); }
  void write(const cv::Mat& frame) override { film_.write(frame); }

 private:
  cv::VideoWriter film_;
};

class OpencvCodecs final : public Codecs {
 public:
  [[nodiscard]] cv::Mat decode(const std::vector<unsigned char>& bytes) const override {
    return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  }
  [[nodiscard]] std::vector<unsigned char> encode(const std::string& ending, const cv::Mat& picture,
                                                  const std::vector<int>& settings) const override {
    std::vector<unsigned char> bytes;
    if (!cv::imencode(ending, picture, bytes, settings)) bytes.clear();
    return bytes;
  }
  [[nodiscard]] std::unique_ptr<FilmReader> open_film(const std::string& name,
                                                      bool only_ffmpeg) const override {
    auto film = std::make_unique<Reader>(name, only_ffmpeg);
    return film->is_open() ? std::move(film) : nullptr;
  }
  [[nodiscard]] std::unique_ptr<FilmWriter> create_film(const std::string& name, const std::string& codec,
                                                        double rate, cv::Size size) const override {
    auto film = std::make_unique<Writer>(name, codec, rate, size);
    return film->is_open() ? std::move(film) : nullptr;
  }
};

}  // namespace

}  // namespace twincell::imaging

extern "C" __attribute__((visibility("default"))) const twincell::imaging::Codecs* twincell_codecs() {
  static const twincell::imaging::OpencvCodecs codecs;
  return &codecs;
}
