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

/// Number of `n` bytes at b.
std::uint64_t unsigned_number(const std::uint8_t* b, std::size_t n, bool big_first) {
  std::uint64_t v = 0;
  for (std::size_t i = 0; i < n; ++i) v |= std::uint64_t{b[big_first ? n - 1 - i : i]} << (8 * i);
  return v;
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
    const std::size_t length = unsigned_number(&b[at], 4, true);
    if (length > b.size() - at - 12) break;
    if (crc32(&b[at + 4], length + 4) != unsigned_number(&b[at + 8 + length], 4, true))
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

/// Walks the directories of a TIFF or BigTIFF (one per page) without reading the pixels. A decoder stops at
/// the first link of the chain that points nowhere, so that a truncated stack looks like a shorter one.
class TiffWalk {
 public:
  explicit TiffWalk(const fs::path& file) : file_(file), in_(file, std::ios::binary) {
    if (!in_) refuse(file_, "cannot be opened for reading.");
    std::error_code ignored;
    size_ = fs::file_size(file_, ignored);
  }
  void require_whole() {
    if (size_ == 0) refuse(file_, "is empty.");
    const std::vector<std::uint8_t> head = size_ >= 8 ? bytes(0, 8) : std::vector<std::uint8_t>(8);
    big_first_ = head[0] == 'M';
    const std::uint64_t version = unsigned_number(&head[2], 2, big_first_);
    if (head[0] != head[1] || (head[0] != 'I' && head[0] != 'M') || (version != 42 && version != 43))
      refuse(file_, "is not a TIFF picture.");
    wide_ = version == 43;
    std::uint64_t at = wide_ ? number(8, 8) : number(4, 4);
    // A chain longer than the file has room for goes round in circles.
    for (std::uint64_t links = 0; at != 0; ++links) {
      if (links > size_ / 8) refuse(file_, "is damaged: its chain of pages has no end.");
      at = after(at);
    }
  }

 private:
  // Checks the directory at `at`; returns where the next one is.
  std::uint64_t after(std::uint64_t at) {
    const std::uint64_t count_bytes = wide_ ? 8 : 2, entry_bytes = wide_ ? 20 : 12, word = wide_ ? 8 : 4;
    const std::uint64_t n = number(at, count_bytes);
    if (n > size_ / entry_bytes) truncated();
    std::vector<std::uint64_t> offsets, lengths;
    for (std::uint64_t i = 0; i < n; ++i) {
      const std::uint64_t entry = at + count_bytes + i * entry_bytes, tag = number(entry, 2);
      if (tag == 273 || tag == 324) offsets = values(entry);  // StripOffsets, TileOffsets
      if (tag == 279 || tag == 325) lengths = values(entry);  // their byte counts
    }
    for (std::size_t i = 0; i < std::min(offsets.size(), lengths.size()); ++i)
      if (offsets[i] > size_ || lengths[i] > size_ - offsets[i]) truncated();
    return number(at + count_bytes + n * entry_bytes, word);
  }
  std::vector<std::uint64_t> values(std::uint64_t entry) {
    const std::uint64_t type = number(entry + 2, 2), word = wide_ ? 8 : 4;
    const std::uint64_t each = type == 3 ? 2 : type == 4 ? 4 : type == 16 ? 8 : 0;  // SHORT, LONG, LONG8
    const std::uint64_t n = number(entry + 4, word), here = entry + 4 + word;
    if (each == 0) return {};
    if (n > size_ / each) truncated();
    const std::uint64_t from = n * each <= word ? here : number(here, word);
    const std::vector<std::uint8_t> b = bytes(from, n * each);
    std::vector<std::uint64_t> v;
    for (std::uint64_t i = 0; i < n; ++i) v.push_back(unsigned_number(&b[i * each], each, big_first_));
    return v;
  }
  std::uint64_t number(std::uint64_t at, std::uint64_t n) {
    return unsigned_number(bytes(at, n).data(), n, big_first_);
  }
  std::vector<std::uint8_t> bytes(std::uint64_t at, std::uint64_t n) {
    if (at > size_ || n > size_ - at) truncated();
    std::vector<std::uint8_t> b(n);
    in_.seekg(static_cast<std::streamoff>(at));
    in_.read(reinterpret_cast<char*>(b.data()), static_cast<std::streamsize>(n));
    if (!in_) truncated();
    return b;
  }
  [[noreturn]] void truncated() {
    refuse(file_, fmt::format("is truncated: a TIFF page does not end within its {} bytes.", size_));
  }
  fs::path file_;
  std::ifstream in_;
  std::uint64_t size_ = 0;
  bool big_first_ = false, wide_ = false;
};

void require_whole_bmp(const fs::path& file, const std::vector<std::uint8_t>& b) {
  if (b.size() < 6 || b[0] != 'B' || b[1] != 'M') refuse(file, "is not a BMP picture.");
  if (unsigned_number(&b[2], 4, false) > b.size())
    refuse(file, fmt::format("is truncated: the BMP picture does not end within its {} bytes.", b.size()));
}

void require_whole(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) refuse(file, "is a folder, not a picture.");
  if (is_tiff(file)) return TiffWalk(file).require_whole();
  const std::vector<std::uint8_t> bytes = bytes_of(file);
  if (bytes.empty()) refuse(file, "is empty.");
  const std::string e = extension_of(file);
  if (e == ".png") require_whole_png(file, bytes);
  if (e == ".jpg" || e == ".jpeg") require_whole_jpeg(file, bytes);
  if (e == ".bmp") require_whole_bmp(file, bytes);
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
