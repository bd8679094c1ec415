#include "imaging/frame_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <string_view>

#include "analysis/trajectory/error.hpp"

namespace twincell {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 7> kPictures = {".png",  ".tif", ".tiff", ".jpg",
                                                       ".jpeg", ".bmp", ".pgm"};
constexpr std::array<std::string_view, 6> kVideos = {".avi", ".mp4", ".mkv", ".mov", ".m4v", ".cine"};

std::string extension_of(const fs::path& path) {
  std::string e = path.extension().string();
  std::transform(e.begin(), e.end(), e.begin(), [](unsigned char c) { return std::tolower(c); });
  return e;
}

template <class List>
bool is_one_of(const fs::path& path, const List& extensions) {
  return std::find(extensions.begin(), extensions.end(), extension_of(path)) != extensions.end();
}

bool is_tiff(const fs::path& path) {
  const std::string e = extension_of(path);
  return e == ".tif" || e == ".tiff";
}

[[noreturn]] void refuse(const fs::path& file, const std::string& complaint) {
  throw InputError(Where{.file = file.string(), .key = {}}, complaint);
}

std::vector<std::uint8_t> bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) refuse(file, "cannot be opened for reading.");
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::uint32_t big_endian(const std::uint8_t* b) {
  return std::uint32_t{b[0]} << 24 | std::uint32_t{b[1]} << 16 | std::uint32_t{b[2]} << 8 |
         std::uint32_t{b[3]};
}

std::uint32_t crc32(const std::uint8_t* data, std::size_t n) {
  static const std::array<std::uint32_t, 256> table = [] {
    std::array<std::uint32_t, 256> t{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1u) != 0 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
      t[i] = c;
    }
    return t;
  }();
  std::uint32_t crc = 0xFFFFFFFFu;
  for (std::size_t i = 0; i < n; ++i) crc = table[(crc ^ data[i]) & 0xFFu] ^ (crc >> 8);
  return ~crc;
}

// A decoder hands out the readable top of a damaged PNG and stays silent. So the chunks are walked first:
// each must lie inside the file with its checksum right, and the last must be IEND.
void require_whole_png(const fs::path& file, const std::vector<std::uint8_t>& b) {
  constexpr std::array<std::uint8_t, 8> magic = {0x89, 'P', 'N', 'G', 0x0D, 0x0A, 0x1A, 0x0A};
  if (b.size() < 8 || !std::equal(magic.begin(), magic.end(), b.begin()))
    refuse(file, "is not a PNG picture.");
  for (std::size_t at = 8; at + 12 <= b.size();) {
    const std::size_t length = big_endian(&b[at]);
    if (length > b.size() - at - 12) break;
    if (crc32(&b[at + 4], length + 4) != big_endian(&b[at + 8 + length]))
      refuse(file, fmt::format("is damaged: the PNG chunk at byte {} fails its checksum.", at));
    if (std::equal(&b[at + 4], &b[at + 8], "IEND")) return;
    at += 12 + length;
  }
  refuse(file, fmt::format("is truncated: the PNG picture does not end within its {} bytes.", b.size()));
}

void require_whole_jpeg(const fs::path& file, const std::vector<std::uint8_t>& b) {
  if (b.size() < 4 || b[0] != 0xFF || b[1] != 0xD8) refuse(file, "is not a JPEG picture.");
  std::size_t end = b.size();
  while (end > 2 && b[end - 1] == 0) --end;  // some cameras pad with zeros
  if (b[end - 2] != 0xFF || b[end - 1] != 0xD9)
    refuse(file, fmt::format("is truncated: the JPEG picture does not end within its {} bytes.", b.size()));
}

void require_whole(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) refuse(file, "is a folder, not a picture.");
  const std::vector<std::uint8_t> bytes = bytes_of(file);
  if (bytes.empty()) refuse(file, "is empty.");
  const std::string e = extension_of(file);
  if (e == ".png") require_whole_png(file, bytes);
  if (e == ".jpg" || e == ".jpeg") require_whole_jpeg(file, bytes);
}

/// One grey channel, bit depth kept.
cv::Mat grey(const cv::Mat& picture, const fs::path& file) {
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

/// Remembers the size of the first frame and refuses another one.
class SizeGuard {
 public:
  void check(const cv::Mat& frame, const std::string& file) {
    if (first_file_.empty()) {
      size_ = frame.size();
      first_file_ = file;
    } else if (frame.size() != size_) {
      refuse(file,
             fmt::format("is {} x {} pixels, but {} is {} x {}: all frames of a stack must have one size.",
                         frame.cols, frame.rows, first_file_, size_.width, size_.height));
    }
  }

 private:
  cv::Size size_;
  std::string first_file_;
};

// OpenCV's own failures (exceptions, empty pictures) become one sentence.
template <class Read>
void decode(const fs::path& file, Read&& read) {
  try {
    read();
  } catch (const cv::Exception&) {
    refuse(file, "cannot be decoded as a picture.");
  }
}

class PictureFiles : public FrameSource {
 public:
  explicit PictureFiles(std::vector<fs::path> files) : files_(std::move(files)) {}

  bool next(cv::Mat& frame) override {
    if (at_ == files_.size()) return false;
    const fs::path& file = files_[at_++];
    require_whole(file);
    cv::Mat picture;
    decode(file, [&] { picture = cv::imread(file.string(), cv::IMREAD_UNCHANGED); });
    if (picture.empty()) refuse(file, "cannot be decoded as a picture.");
    frame = grey(picture, file);
    guard_.check(frame, file.string());
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return files_.size(); }
  [[nodiscard]] std::string current() const override { return files_[at_ > 0 ? at_ - 1 : 0].string(); }

 private:
  std::vector<fs::path> files_;
  std::size_t at_ = 0;
  SizeGuard guard_;
};

class TiffPages : public FrameSource {
 public:
  explicit TiffPages(fs::path file) : file_(std::move(file)) {
    require_whole(file_);
    decode(file_, [&] { pages_ = cv::imcount(file_.string(), cv::IMREAD_UNCHANGED); });
    if (pages_ == 0) refuse(file_, "cannot be decoded as a TIFF stack.");
    refuse_hidden_pages();
  }

  bool next(cv::Mat& frame) override {
    if (at_ == pages_) return false;
    if (at_ >= first_of_block_ + block_.size()) read_block();
    frame = grey(block_[at_ - first_of_block_], file_);
    ++at_;
    guard_.check(frame, current());
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return pages_; }
  [[nodiscard]] std::string current() const override {
    return pages_ == 1 ? file_.string() : fmt::format("{}, page {}", file_.string(), at_);
  }

 private:
  void read_block() {
    constexpr std::size_t pages_per_block = 16;
    first_of_block_ = at_;
    const std::size_t wanted = std::min(pages_per_block, pages_ - at_);
    block_.clear();
    decode(file_, [&] {
      cv::imreadmulti(file_.string(), block_, static_cast<int>(at_), static_cast<int>(wanted),
                      cv::IMREAD_UNCHANGED);
    });
    if (block_.size() != wanted ||
        std::any_of(block_.begin(), block_.end(), [](auto& p) { return p.empty(); }))
      refuse(file_, fmt::format("is truncated or damaged: of {} pages, page {} cannot be read.", pages_,
                                at_ + block_.size() + 1));
  }
  // ImageJ writes stacks above 4 GB as one page with the other planes behind it; a TIFF reader sees the first
  // only.
  void refuse_hidden_pages() const {
    std::ifstream in(file_, std::ios::binary);
    std::string head(65536, '\0');
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    const std::size_t at = head.find("\nimages=");
    if (at == std::string::npos || head.find("ImageJ=") == std::string::npos) return;
    const unsigned long says = std::strtoul(head.c_str() + at + 8, nullptr, 10);
    if (says > pages_)
      refuse(file_, fmt::format(
                        "says that it holds {} ImageJ planes, but only {} can be read: save it as a stack of "
                        "pages or as single files.",
                        says, pages_));
  }

  fs::path file_;
  std::size_t pages_ = 0;
  std::size_t at_ = 0;
  std::size_t first_of_block_ = 0;
  std::vector<cv::Mat> block_;
  SizeGuard guard_;
};

class Video : public FrameSource {
 public:
  explicit Video(fs::path file) : file_(std::move(file)) {
    if (!std::ifstream(file_, std::ios::binary)) refuse(file_, "cannot be opened for reading.");
    decode(file_, [&] { capture_.open(file_.string()); });
    if (!capture_.isOpened()) refuse(file_, "cannot be decoded as a video.");
    announced_ = static_cast<std::size_t>(std::max(0.0, capture_.get(cv::CAP_PROP_FRAME_COUNT)));
  }
  bool next(cv::Mat& frame) override {
    cv::Mat picture;
    if (!capture_.read(picture) || picture.empty()) {
      if (at_ == 0) refuse(file_, "holds no frame that can be decoded.");
      return false;
    }
    ++at_;
    frame = grey(picture, file_);
    guard_.check(frame, current());
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return announced_; }
  [[nodiscard]] std::string current() const override {
    return fmt::format("{}, frame {}", file_.string(), at_);
  }

 private:
  fs::path file_;
  cv::VideoCapture capture_;
  std::size_t announced_ = 0;
  std::size_t at_ = 0;
  SizeGuard guard_;
};

std::unique_ptr<FrameSource> open_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (is_one_of(entry.path(), kPictures)) files.push_back(entry.path());
  if (error) refuse(folder, "cannot be listed: " + error.message() + ".");
  if (files.empty()) refuse(folder, "holds no PNG, TIFF, JPEG, BMP or PGM picture.");
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return std::make_unique<PictureFiles>(std::move(files));
}

}  // namespace

bool natural_less(const std::string& a, const std::string& b) {
  auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a[i]) && digit(b[j])) {
      std::size_t ie = i, je = j;
      while (ie < a.size() && digit(a[ie])) ++ie;
      while (je < b.size() && digit(b[je])) ++je;
      while (i < ie && a[i] == '0') ++i;
      while (j < je && b[j] == '0') ++j;
      if (ie - i != je - j) return ie - i < je - j;
      const int order = a.compare(i, ie - i, b, j, je - j);
      if (order != 0) return order < 0;
      i = ie;
      j = je;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (i == a.size() && j == b.size()) return a < b;
  return i == a.size();
}

std::unique_ptr<FrameSource> open_frames(const fs::path& stack) {
  cv::utils::logging::setLogLevel(
      cv::utils::logging::LOG_LEVEL_SILENT);  // its complaints become our sentences
  std::error_code error;
  if (!fs::exists(stack, error)) refuse(stack, "does not exist.");
  if (fs::is_directory(stack, error)) return open_folder(stack);
  if (is_tiff(stack)) return std::make_unique<TiffPages>(stack);
  if (is_one_of(stack, kPictures)) return std::make_unique<PictureFiles>(std::vector<fs::path>{stack});
  if (is_one_of(stack, kVideos)) return std::make_unique<Video>(stack);
  refuse(stack,
         "is not a stack of frames: a folder of pictures, a PNG, TIFF, JPEG, BMP or PGM picture, or an AVI, "
         "MP4, MKV, MOV, M4V or CINE video is expected.");
}

}  // namespace twincell
