#include "imaging/stack/formats/ffmpeg_pipe.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <map>
#include <utility>

#include "core/cancellation.hpp"
#include "imaging/stack/formats/byte_file.hpp"
#include "imaging/stack/formats/raw_pixels.hpp"

extern char** environ;  // NOLINT: no POSIX header declares it

namespace twincell::imaging::frames {

namespace {

namespace fs = std::filesystem;

/// A child process whose output is read. The destructor ends it.
class Child {
 public:
  /// \param words program (looked up in PATH) and its arguments
  explicit Child(std::vector<std::string> words) : errors_(std::tmpfile()) {
    std::array<int, 2> ends{-1, -1};
    if (errors_ == nullptr || pipe2(ends.data(), O_CLOEXEC) != 0) return;
    out_ = ends[0];
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
    posix_spawn_file_actions_adddup2(&actions, fileno(errors_), 2);
    posix_spawn_file_actions_addclosefrom_np(&actions, 3);  // HDF5 and stdio have open files, too
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (posix_spawnp(&child_, argv[0], &actions, nullptr, argv.data(), environ) != 0) child_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (child_ > 0) kill(child_, SIGKILL);
    (void)wait();
    if (out_ >= 0) close(out_);
    if (errors_ != nullptr) std::fclose(errors_);
  }

  /// Reads up to n bytes of its output; fewer only at the end of the output.
  std::size_t read(std::uint8_t* to, std::size_t n) const {
    std::size_t got = 0;
    while (got < n) {
      const ssize_t now = ::read(out_, to + got, n - got);
      if (now < 0 && errno == EINTR) {
        throw_if_cancelled();
        continue;
      }
      if (now <= 0) break;
      got += static_cast<std::size_t>(now);
    }
    return got;
  }
  /// Waits for its end. True if it ran and exited with status 0.
  bool wait() {
    if (child_ <= 0) return ended_well_;
    int status = 0;
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = -1;
    return ended_well_ = WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
  /// The last line of its error output.
  [[nodiscard]] std::string complaint() const {
    std::array<char, 400> line{};
    std::string last;
    std::rewind(errors_);
    while (std::fgets(line.data(), line.size(), errors_) != nullptr)
      if (line[0] != '\n') last = line.data();
    // Remove a prefix such as "[matroska,webm @ 0x55d0c0]": the address does not help the user.
    if (const std::size_t end = last.find("] "); last.starts_with('[') && end != std::string::npos)
      last.erase(0, end + 2);
    while (!last.empty() && (last.back() == '\n' || last.back() == '.')) last.pop_back();
    return last;
  }

 private:
  std::FILE* errors_;
  pid_t child_ = -1;
  int out_ = -1;
  bool ended_well_ = false;
};

std::string all_output(Child& child) {
  std::string all;
  std::array<std::uint8_t, 4096> part{};
  for (std::size_t n; (n = child.read(part.data(), part.size())) > 0 && all.size() < 65536;)
    all.append(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(n));
  return all;
}

double number(const std::string& text) {
  double value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

int bits_of(const std::string& pixels, const std::string& raw_bits) {
  if (const int stated = static_cast<int>(number(raw_bits)); stated >= 1 && stated <= 16) return stated;
  for (const int bits : {9, 10, 12, 14, 16})
    if (pixels.ends_with(fmt::format("{}le", bits)) || pixels.ends_with(fmt::format("{}be", bits)))
      return bits;
  return pixels.starts_with("rgb48") || pixels.starts_with("bgr48") || pixels.starts_with("rgba64") ? 16 : 8;
}

class Piped final : public FrameSource {
 public:
  Piped(const fs::path& file, const VideoFacts& facts) : file_(file) {
    // A bit depth to which ffmpeg converts without rescaling the values.
    const int bits = facts.bits <= 8    ? 8
                     : facts.bits <= 10 ? 10
                     : facts.bits <= 12 ? 12
                     : facts.bits <= 14 ? 14
                                        : 16;
    layout_ = {.width = facts.width, .height = facts.height, .stored_bits = bits == 8 ? 8 : 16};
    require_plausible_size(file, static_cast<std::uint64_t>(std::max(0, facts.width)),
                           static_cast<std::uint64_t>(std::max(0, facts.height)), 2, fs::file_size(file));
    info_.format = fmt::format("video ({}) read by ffmpeg", facts.pixels);
    info_.width = facts.width;
    info_.height = facts.height;
    info_.bits = bits;
    if (facts.frame_rate_hz > 0) info_.frame_rate_hz = facts.frame_rate_hz;
    info_.playback = true;
    if (!facts.pixels.starts_with("gray"))
      info_.notes.emplace_back("a video in colour: its grey values are not those the camera measured.");
    const std::string grey = bits == 8 ? "gray" : fmt::format("gray{}le", bits);
    child_ = std::make_unique<Child>(std::vector<std::string>{"ffmpeg",    "-v",
                                                              "error",     "-nostdin",
                                                              "-xerror",   "-protocol_whitelist",
                                                              "file,pipe", "-format_whitelist",
                                                              kContainers, "-noautorotate",
                                                              "-i",        ffmpeg_name(file),
                                                              "-map",      "0:v:0",
                                                              "-fps_mode", "passthrough",
                                                              "-f",        "rawvideo",
                                                              "-pix_fmt",  grey,
                                                              "pipe:1"});
  }

  bool next(cv::Mat& frame) override {
    raw_.resize(layout_.bytes());
    const std::size_t got = child_->read(raw_.data(), raw_.size());
    if (got < raw_.size()) {
      // ffmpeg exits with status 0 even if the file ends within a frame, but it prints an error.
      const bool well = child_->wait();
      if (const std::string said = child_->complaint(); !well || got > 0 || !said.empty())
        refuse(file_, fmt::format("cannot be read beyond frame {}; ffmpeg says {}.", read_, in_quotes(said)));
      if (read_ == 0) refuse(file_, "holds no frame that can be decoded.");
      return false;
    }
    frame = unpack(raw_.data(), layout_);
    ++read_;
    return true;
  }
  [[nodiscard]] std::size_t announced() const override {
    if (!counted_) counted_ = count_frames(file_).value_or(0);
    return *counted_;
  }
  [[nodiscard]] std::string current() const override {
    return fmt::format("{}, frame {}", file_.string(), read_ > 0 ? read_ - 1 : 0);
  }
  [[nodiscard]] StackInfo info() const override { return info_; }

 private:
  fs::path file_;
  mutable std::optional<std::size_t> counted_;
  std::size_t read_ = 0;
  RawLayout layout_;
  StackInfo info_;
  std::unique_ptr<Child> child_;
  std::vector<std::uint8_t> raw_;
};

}  // namespace

std::string ffmpeg_name(const fs::path& file) {
  return "file:" + file.string();
}

bool ffmpeg_is_installed() {
  static const bool both = [] {
    for (const char* program : {"ffmpeg", "ffprobe"}) {
      Child child({program, "-version"});
      (void)all_output(child);
      if (!child.wait()) return false;
    }
    return true;
  }();
  return both;
}

std::optional<VideoFacts> probe_video(const fs::path& file) {
  Child child({"ffprobe", "-v", "error", "-protocol_whitelist", "file,pipe", "-format_whitelist", kContainers,
               "-select_streams", "v:0", "-show_entries",
               "stream=width,height,pix_fmt,bits_per_raw_sample,avg_frame_rate", "-of",
               "default=noprint_wrappers=1", ffmpeg_name(file)});
  const std::string output = all_output(child);
  if (!child.wait()) return {};
  std::map<std::string, std::string> said;
  for (std::size_t at = 0; at < output.size();) {
    const std::size_t end = std::min(output.find('\n', at), output.size());
    const std::string line = output.substr(at, end - at);
    if (const std::size_t equals = line.find('='); equals != std::string::npos)
      said.emplace(line.substr(0, equals), line.substr(equals + 1));
    at = end + 1;
  }
  VideoFacts facts;
  facts.width = static_cast<int>(number(said["width"]));
  facts.height = static_cast<int>(number(said["height"]));
  if (facts.width < 1 || facts.height < 1) return {};
  facts.pixels = said["pix_fmt"];
  facts.bits = bits_of(facts.pixels, said["bits_per_raw_sample"]);
  const std::string& rate = said["avg_frame_rate"];
  const std::size_t slash = rate.find('/');
  const double below = slash == std::string::npos ? 1 : number(rate.substr(slash + 1));
  if (below > 0) facts.frame_rate_hz = number(rate.substr(0, slash)) / below;
  return facts;
}

std::optional<std::size_t> count_frames(const fs::path& file) {
  Child child({"ffprobe", "-v", "error", "-protocol_whitelist", "file,pipe", "-format_whitelist", kContainers,
               "-select_streams", "v:0", "-count_packets", "-show_entries", "stream=nb_read_packets", "-of",
               "default=noprint_wrappers=1:nokey=1", ffmpeg_name(file)});
  const std::string output = all_output(child);
  const double n = number(output);
  if (!child.wait() || !(n > 0) || n > 1e15) return {};
  return static_cast<std::size_t>(n);
}

std::unique_ptr<FrameSource> open_ffmpeg(const fs::path& file, const VideoFacts& facts) {
  return std::make_unique<Piped>(file, facts);
}

}  // namespace twincell::imaging::frames
