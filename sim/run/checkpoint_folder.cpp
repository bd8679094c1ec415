#include "sim/run/checkpoint_folder.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <regex>

#include "core/error.hpp"
#include "core/provenance.hpp"
#include "core/sha256.hpp"

namespace twincell::sim {

namespace fs = std::filesystem;

namespace {

constexpr const char* kState = "state.h5";

/// Whether a name is that of an unfinished file of this program (temporary_files.hpp).
bool is_unfinished(const std::string& name) {
  static const std::regex pattern(R"(\.twincell-[0-9a-f]{16}(-[0-9a-v]{12}\.part\.h5|\.lock))");
  return std::regex_match(name, pattern);
}

/// Whether a file contains frames of this scene.
bool has_frames_of(const fs::path& file, const Scene& scene) {
  if (!fs::is_regular_file(fs::symlink_status(file))) return false;
  try {
    return is_of_scene(H5mdReader(file).info().provenance_json, scene);
  } catch (const Error&) {  // damaged, or of another program
    return false;
  }
}

}  // namespace

fs::path CheckpointFolder::of(const fs::path& output) {
  fs::path folder = output;
  return folder += ".checkpoint";
}

bool CheckpointFolder::holds_a_run(const fs::path& folder) {
  return fs::exists(folder / kState);
}

fs::path CheckpointFolder::segment(std::size_t index) const {
  return folder_ / fmt::format("segment-{:04}.h5", index + 1);
}

CheckpointFolder::CheckpointFolder(fs::path folder, const Scene& scene,
                                   const std::function<std::string()>& make_provenance)
    : folder_(std::move(folder)) {
  const Where where{folder_.string(), 0, 0, ""};
  std::error_code ec;
  if (fs::is_symlink(fs::symlink_status(folder_, ec)))
    throw ConfigError(where,
                      "the checkpoint folder is a link, through which files elsewhere would be removed.");
  fs::create_directory(folder_, ec);
  if (ec || !fs::is_directory(folder_, ec) || ::access(folder_.c_str(), R_OK | W_OK | X_OK) != 0)
    throw ConfigError(where, "the checkpoint folder cannot be created or written to.");
  // The lock lasts until the process ends, normally or not.
  lock_ = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ >= 0 && ::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw ConfigError(where, "another process is running this scene into the same output.");

  found_ = holds_a_run(folder_);
  if (found_) {
    checkpoint_ = read_checkpoint(folder_ / kState);
    require_same_run(scene, checkpoint_, folder_);
    for (std::size_t k = 0; k < checkpoint_.segments.size(); ++k)
      if (!fs::exists(segment(k)) || sha256_of(segment(k)) != checkpoint_.segments[k].sha256)
        throw InputError({segment(k).string(), 0, 0, ""},
                         "the file is missing or damaged, and the run cannot be resumed without it.");
  } else {
    checkpoint_.scene = scene.resolved;
    checkpoint_.provenance = make_provenance();
  }
  require_own_files(scene);
  remove_strays();
}

CheckpointFolder::~CheckpointFolder() {
  writer_.reset();
  std::error_code ec;
  if (!found_) fs::remove(folder_, ec);  // nothing was saved; foreign files remain
  if (lock_ >= 0) ::close(lock_);
}

std::vector<fs::path> CheckpointFolder::later_segments() const {
  std::vector<fs::path> all;
  for (std::size_t k = checkpoint_.segments.size(); fs::exists(fs::symlink_status(segment(k))); ++k)
    all.push_back(segment(k));
  return all;
}

void CheckpointFolder::require_own_files(const Scene& scene) const {
  const auto refuse = [&](const fs::path& file, const std::string& complaint) {
    throw ConfigError({folder_.string(), 0, 0, ""},
                      fmt::format("'{}' in the checkpoint folder {}; move it, or name another output.",
                                  file.filename().string(), complaint));
  };
  const std::vector<fs::path> later = later_segments();
  for (const fs::path& file : later)
    if (!has_frames_of(file, scene)) refuse(file, "does not contain frames of this run");
  if (found_) return;  // other files stay as they are
  for (const auto& entry : fs::directory_iterator(folder_))
    if (std::find(later.begin(), later.end(), entry.path()) == later.end() &&
        !is_unfinished(entry.path().filename().string()))
      refuse(entry.path(), "was not written by this program");
}

void CheckpointFolder::remove_strays() const {
  // As a killed run leaves them. Segments after a gap may be the user's.
  std::vector<fs::path> strays = later_segments();
  for (const auto& entry : fs::directory_iterator(folder_))
    if (is_unfinished(entry.path().filename().string())) strays.push_back(entry.path());
  // The last segment first: what a killed program leaves has no gap.
  std::sort(strays.begin(), strays.end());
  for (auto stray = strays.rbegin(); stray != strays.rend(); ++stray) fs::remove(*stray);
}

template <class Work>
void CheckpointFolder::saving(Work work) const {
  try {
    work();
  } catch (const Error& e) {
    if (!found_) throw NotSaved(ExitCode::failed, e.what());
    throw NotSaved(ExitCode::partial, fmt::format("{} The run up to step {} is in {}; --resume continues it.",
                                                  e.what(), checkpoint_.state.step, folder_.string()));
  }
}

void CheckpointFolder::append(const Frame& frame) {
  saving([&] {
    if (!writer_) writer_ = std::make_unique<H5mdWriter>(segment(checkpoint_.segments.size()), info_);
    writer_->append(frame);
    ++frames_;
  });
}

void CheckpointFolder::finish_segment() {
  if (!writer_) return;
  writer_->finish();
  writer_.reset();
  checkpoint_.segments.push_back({frames_, sha256_of(segment(checkpoint_.segments.size()))});
  frames_ = 0;
}

void CheckpointFolder::save(RunState state) {
  saving([&] {
    finish_segment();
    Checkpoint next{checkpoint_.scene, checkpoint_.provenance, version_line(), checkpoint_.segments,
                    std::move(state)};
    write_checkpoint(folder_ / kState, next);
    checkpoint_ = std::move(next);
    found_ = true;
  });
}

void CheckpointFolder::gather(TrajectorySink& out, const std::function<void()>& finish) {
  saving([&] {
    finish_segment();
    Frame frame;
    for (std::size_t k = 0; k < checkpoint_.segments.size(); ++k) {
      const H5mdReader reader(segment(k));
      for (std::size_t f = 0; f < reader.n_frames(); ++f) {
        reader.read(f, frame);
        out.append(frame);
      }
    }
    finish();
  });
  remove();
}

void CheckpointFolder::remove() {
  // The state first: a folder without a state is treated as new.
  fs::remove(folder_ / kState);
  checkpoint_.segments.clear();
  found_ = false;
  writer_.reset();
  remove_strays();
  std::error_code ec;
  fs::remove(folder_, ec);  // fails if foreign files are in it
}

}  // namespace twincell::sim
