// A folder of pictures, in natural order of their names.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "imaging/stack/formats/byte_file.hpp"
#include "imaging/stack/formats/frame_numbers.hpp"
#include "imaging/stack/formats/reader.hpp"
#include "imaging/stack/formats/size_guard.hpp"

namespace twincell::imaging::frames {

extern const Reader tiff_reader, picture_reader;

namespace {

namespace fs = std::filesystem;

bool is_listed(const std::string& extensions, const fs::path& file) {
  std::string e = file.extension().string();
  std::transform(e.begin(), e.end(), e.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return !e.empty() && (extensions + " ").find(e + " ") != std::string::npos;
}

/// Opens a picture or a TIFF stack. Its content decides which of the two it is, not its name. Any other file
/// with the name of a picture is damaged and must not reach the video decoder, which accepts any bytes.
std::unique_ptr<FrameSource> open_picture(const fs::path& file) {
  const Reader& reader = reader_of(head_of(file));
  if (&reader != &tiff_reader && &reader != &picture_reader)
    refuse(file, "is not what its name says: it contains no picture.");
  return reader.open(file, "");
}

class Folder final : public FrameSource {
 public:
  Folder(std::vector<fs::path> files, std::size_t other_files, const std::vector<std::string>& notes)
      : files_(std::move(files)) {
    open(0);
    info_ = source_->info();
    info_.notes.insert(info_.notes.begin(), notes.begin(), notes.end());
    info_.format = fmt::format("{} files, the first: {}", files_.size(), info_.format);
    info_.other_files = other_files;
    std::vector<std::string> names;
    for (const fs::path& file : files_) names.push_back(file.filename().string());
    for (std::string& sentence : notes_on_names(names)) info_.notes.push_back(std::move(sentence));
    info_.frame_rate_hz.reset();
    announced_ = files_.size();
    // A stack of many pages that is split into files: count the pages of every file.
    if (source_->announced() > 1) {
      announced_ = source_->announced();
      for (std::size_t i = 1; i < files_.size(); ++i) announced_ += open_picture(files_[i])->announced();
    }
  }

  bool next(cv::Mat& frame) override {
    for (; !source_->next(frame); open(at_ + 1))
      if (at_ + 1 == files_.size()) return false;
    guard_.check(frame, source_->current());
    return true;
  }
  [[nodiscard]] std::size_t announced() const override { return announced_; }
  [[nodiscard]] std::string current() const override { return source_->current(); }
  [[nodiscard]] StackInfo info() const override { return info_; }

 private:
  void open(std::size_t i) {
    source_ = open_picture(files_[i]);
    at_ = i;
  }

  std::vector<fs::path> files_;
  std::size_t at_ = 0, announced_ = 0;
  std::unique_ptr<FrameSource> source_;
  SizeGuard guard_;
  StackInfo info_;
};

/// The note on pictures that are no frames of the other `frames` pictures' series.
std::string left_out(const std::vector<std::string>& names, std::size_t frames) {
  constexpr std::size_t kMaxNamed = 3;
  const std::size_t more = names.size() - std::min(names.size(), kMaxNamed);
  const std::vector<std::string> named(names.begin(), names.end() - static_cast<std::ptrdiff_t>(more));
  return fmt::format(
      "{}{} {} left out, because the name does not belong to the series of the other {} pictures; name a "
      "frame like them.",
      fmt::join(named, ", "), more > 0 ? fmt::format(" and {} more", more) : "",
      names.size() == 1 ? "is" : "are", frames);
}

/// "; its folder frames does", for a folder above that of the pictures.
std::string folders_with_pictures(const fs::path& folder) {
  constexpr std::size_t kMaxNamed = 3;
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator below(folder, error), end; !error && below != end; below.increment(error)) {
    std::error_code ignored;
    if (!below->is_directory(ignored)) continue;
    for (fs::directory_iterator file(*below, ignored); !ignored && file != end; file.increment(ignored))
      if (is_picture_of_folder(file->path())) {
        names.push_back(below->path().filename().string());
        break;
      }
  }
  if (names.empty()) return {};
  std::sort(names.begin(), names.end(), natural_less);
  const std::string more = names.size() > kMaxNamed ? ", …" : "";
  names.resize(std::min(names.size(), kMaxNamed));
  return names.size() == 1 ? fmt::format("; its folder {} does", names.front())
                           : fmt::format("; its folders {}{} do", fmt::join(names, ", "), more);
}

}  // namespace

bool is_picture_of_folder(const fs::path& file) {
  static const std::string pictures = fmt::format("{} {}", picture_reader.extensions, tiff_reader.extensions);
  return is_listed(pictures, file);
}

std::unique_ptr<FrameSource> open_folder(const fs::path& folder) {
  std::string all;
  for (const Reader* reader : readers()) all += fmt::format("{} ", reader->extensions);
  std::vector<fs::path> files;
  std::size_t others = 0;
  std::string stack;  // a file in the folder that is a stack by itself
  std::error_code error, ignored;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const fs::path& file = entry.path();
    if (file.filename().string().starts_with('.') || entry.is_directory(ignored)) continue;
    if (is_picture_of_folder(file)) {
      files.push_back(file);
    } else {
      ++others;
      if (stack.empty() && is_listed(all, file)) stack = file.filename().string();
    }
  }
  if (error) refuse(folder, "cannot be listed: " + error.message() + ".");
  if (files.empty())
    refuse(folder, stack.empty() ? fmt::format("holds no PNG, TIFF, JPEG, BMP or PGM picture{}.",
                                               folders_with_pictures(folder))
                                 : fmt::format("holds no PNG, TIFF, JPEG, BMP or PGM picture; "
                                               "it holds {}: name that file.",
                                               stack));
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.filename().string());
  const std::vector<std::string> outside = outside_the_series(names);
  std::erase_if(names,
                [&](const std::string& name) { return std::ranges::find(outside, name) != outside.end(); });
  sort_as_frames(names);
  files.clear();
  for (const std::string& name : names) files.push_back(folder / name);
  std::vector<std::string> notes;
  if (!outside.empty()) notes.push_back(left_out(outside, names.size()));
  return std::make_unique<Folder>(std::move(files), others, notes);
}

}  // namespace twincell::imaging::frames
