#include "sim/event_driven/event_driven_solver.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>

#include "sim/event_driven/ballistic_paths.hpp"
#include "sim/event_driven/binary_collision.hpp"
#include "sim/event_driven/cluster.hpp"
#include "sim/event_driven/event_queue.hpp"
#include "sim/system/cell_grid.hpp"

namespace twincell::sim {

namespace {

constexpr double kTolerance = 1e-7;  // of a collision
constexpr double kLongest = 20;  // contact times: a longer contact is a resting one and is left to time steps
// Initial interval, in contact times, between attempts to start event-driven motion. It doubles when an
// attempt fails: three bodies stay together for one or two contact times, and an attempt costs as much as a
// hundred steps.
constexpr double kLookAfter = 2;
constexpr std::int64_t kLookSeldom = 1024;  // steps
constexpr std::size_t kMostInCrowd = 8;     // with more members, all beads are advanced by steps

/// A contact of two bodies that is in progress or has just ended. The paths of its beads are those after the
/// contact.
struct Contact {
  std::int32_t i, j;          ///< i < j; or j = -1 - w for wall w
  double begin, middle, end;  ///< of the contact
  double from, until;         ///< the enclosing whole steps: no other body may touch its beads in between
  /// Largest deviation of each bead from its path in `before` until `middle`, and from its path after the
  /// contact from then on, sigma.
  std::array<double, 2> early, late;
  /// Radius of a ball that contains both beads from `from` to `until` and moves along before[0].
  double about;
  RelativeMotion motion;  ///< at `begin`
  Vec3 shift = Vec3::Zero();
  std::array<BallisticPath, 2> before;
  std::array<Vec3, 2> rim;  ///< R w before the contact
};

/// A cluster of beads until they have parted. Their paths are those after the cluster.
struct ClusterRun {
  Cluster cluster;
  double from, until;                 ///< whole steps: no other body may touch them in between
  std::vector<BallisticPath> before;  ///< path of each at `from`, without the contacts
};

/// State of a bead at one instant.
struct Instant {
  Vec3 r, v, rim;
};

class EventDrivenSolver : public Solver {
 public:
  EventDrivenSolver(const Plan& plan, const GuardLimits& limits, SteppingSolvers steps)
      : plan_(plan),
        limits_(limits),
        look_every_(std::clamp<std::int64_t>(std::llround(kLookAfter * plan.shortest().time / plan.dt), 8,
                                             kLookSeldom)),
        make_steps_(std::move(steps)),
        steps_(make_steps_.all()) {}

  void advance(System& s, std::int64_t steps) override {
    if (s.beads.empty() || steps <= 0) {
      s.step += std::max<std::int64_t>(0, steps);
      return;
    }
    if (flying() && !is_as_left(s)) {
      end_flights();  // the caller changed a bead, the clock or the plate
      steps_ = make_steps_.all();
    }
    if (!flying() && s.step < next_look_ - kLookSeldom)
      next_look_ = 0;  // the step count was reset to an earlier value
    const std::int64_t last = s.step + steps;
    while (s.step < last) flying() ? fly(s, last) : step(s, last);
    if (flying()) {
      write(s);
      check_motion(s, limits_);
      left_ = s.beads;
      left_step_ = s.step;
      left_amplitude_ = s.drive.amplitude;
    }
  }
  [[nodiscard]] std::int64_t list_builds() const override {
    return list_builds_ + (steps_ ? steps_->list_builds() : 0);
  }
  void rebuild_every(std::int64_t n) override {
    if (steps_) steps_->rebuild_every(n);
  }
  [[nodiscard]] std::vector<ContactMemory> contacts() const override {
    return steps_ ? steps_->contacts() : memories_;
  }
  void restore(std::vector<ContactMemory> contacts) override {
    if (steps_) steps_->restore(std::move(contacts));
  }
  [[nodiscard]] std::vector<double> memory() const override {
    Writer out;
    pass(*this, out);
    return out.numbers;
  }
  void recall(const System& s, const std::vector<double>& memory) override {
    if (memory.empty()) return;
    Reader in{memory};
    if (memory.front() != 0) {
      begin_flights(s);
      steps_.reset();
      left_ = s.beads;
      left_step_ = s.step;
      left_amplitude_ = s.drive.amplitude;
    }
    pass(*this, in);
  }
  [[nodiscard]] std::string description() const override {
    return "free flight between contacts; where three bodies meet: " + make_steps_.few()->description();
  }
  [[nodiscard]] Footprint footprint() const override {
    if (steps_) return steps_->footprint();
    constexpr std::size_t kNumbers = 6 + 2 + 3 + 2;  // path, radius and valid_from, rim, mass and turn
    return {mass_.size() * (kNumbers * sizeof(double) + sizeof(Event)), open_.size() * sizeof(Contact),
            open_.size()};
  }
  [[nodiscard]] Counters counters() const override {
    Counters c = steps_ ? steps_->counters() : Counters{};
    c.steps += counted_.steps, c.pair_visits += counted_.pair_visits, c.wall_visits += counted_.wall_visits,
        c.near_refreshes += counted_.near_refreshes;
    return c;
  }

 private:
  [[nodiscard]] bool flying() const { return lines_.has_value(); }
  [[nodiscard]] bool is_as_left(const System& s) const {
    return s.step == left_step_ && s.drive.amplitude == left_amplitude_ && s.beads.size() == left_.size() &&
           std::memcmp(s.beads.data(), left_.data(), left_.size() * sizeof(Bead)) == 0;
  }

  // --- checkpoints ---

  /// Writes numbers in sequence ...
  struct Writer {
    static constexpr bool kReads = false;
    std::vector<double> numbers;
    void operator()(const Vec3& v) {
      for (Eigen::Index k = 0; k < 3; ++k) (*this)(v[k]);
    }
    void operator()(const BallisticPath& line) { (*this)(line.a), (*this)(line.b); }
    template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    void operator()(T x) { numbers.push_back(static_cast<double>(x)); }
  };
  /// ... and reads them.
  struct Reader {
    static constexpr bool kReads = true;
    const std::vector<double>& numbers;
    std::size_t at = 0;
    void operator()(Vec3& v) {
      for (Eigen::Index k = 0; k < 3; ++k) (*this)(v[k]);
    }
    void operator()(BallisticPath& line) { (*this)(line.a), (*this)(line.b); }
    template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    void operator()(T& x) { x = static_cast<T>(at < numbers.size() ? numbers[at++] : 0.0); }
  };
  /// Passes the size of a list; a list that is read is resized.
  template <class List, class Archive>
  static void pass_size(List& list, Archive& a) {
    std::size_t n = list.size();
    a(n);
    if constexpr (Archive::kReads) list.resize(n);
  }
  /// Passes everything, beyond the beads, that event-driven motion or the wait for it depends on. Writing and
  /// reading use the same order. \param k a solver, const for writing
  template <class Self, class Archive>
  static void pass(Self& k, Archive& a) {
    double in_flight = k.flying() ? 1 : 0;
    a(in_flight);
    a(k.next_look_), a(k.wait_);
    if (!k.flying()) return;
    a(k.base_), a(k.now_);
    for (std::size_t i = 0; i < k.lines_->size(); ++i) {
      BallisticPath line = (*k.lines_)[i];
      a(line);
      if constexpr (Archive::kReads) k.lines_->put(i, line);
      a(k.lines_->valid_from(i)), a(k.rim_[i]);
      Event event = k.events_[i];
      a(event.time), a(event.kind), a(event.partner);
      if constexpr (Archive::kReads) k.events_.put(i, event);
    }
    pass_size(k.open_, a);
    for (auto& c : k.open_) {
      a(c.i), a(c.j), a(c.begin), a(c.middle), a(c.end), a(c.from), a(c.until);
      a(c.motion.r), a(c.motion.u), a(c.motion.s), a(c.shift), a(c.about);
      for (std::size_t q = 0; q < 2; ++q) a(c.early[q]), a(c.late[q]), a(c.before[q]), a(c.rim[q]);
    }
    pass_size(k.clusters_, a);
    for (auto& c : k.clusters_) pass(k, c, a);
  }

  template <class Self, class Meeting, class Archive>
  static void pass(Self& k, Meeting& c, Archive& a) {
    auto& h = c.cluster;
    a(c.from), a(c.until);
    if constexpr (Archive::kReads) {
      h.start = k.frame_;
      h.start.forces_known = true;
    }
    pass_size(h.members, a);
    pass_size(h.memories, a);
    a(h.steps);
    std::int64_t since = k.base_ - h.start.step;
    a(since);
    const std::size_t n = h.members.size();
    if constexpr (Archive::kReads) {
      h.stray.resize(n), c.before.resize(n);
      h.start.beads.resize(n), h.start.forces.resize(n);
      h.start.step = k.base_ - since;
    }
    for (std::size_t i = 0; i < n; ++i) {
      auto& b = h.start.beads[i];
      auto& f = h.start.forces[i];
      a(h.members[i]), a(h.stray[i]), a(c.before[i]);
      a(b.x), a(b.y), a(b.z), a(b.vx), a(b.vy), a(b.vz), a(b.spin_x), a(b.spin), a(b.spin_z);
      a(b.radius), a(b.mass), a(b.inertia);
      a(f.x), a(f.y), a(f.z), a(f.q_x), a(f.q), a(f.q_z);
    }
    for (auto& m : h.memories) {
      a(m.i), a(m.j);
      pass_size(m.values, a);
      for (auto& v : m.values) a(v);
    }
  }

  // --- time steps, and the change to event-driven motion ---

  void step(System& s, std::int64_t last) {
    if (next_look_ <= s.step) {
      if (take(s)) {
        wait_ = look_every_;
        return;
      }
      // At multiples of the wait, so that the steps are the same however the run is divided into calls.
      wait_ = next_look_ == 0 ? look_every_ : std::min(kLookSeldom, 2 * wait_);
      next_look_ = (s.step / wait_ + 1) * wait_;
    }
    const std::int64_t n = std::min(last, next_look_) - s.step;
    steps_->advance(s, n);
  }

  /// Changes from time steps to event-driven motion. \returns false, with nothing changed, if three bodies
  /// meet
  bool take(const System& s) {
    const std::size_t n = s.beads.size();
    std::vector<std::int32_t> touching(n, 0);
    std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
    const Vec3 plate = s.plate_displacement();
    for (std::size_t w = 0; w < s.walls.size(); ++w) {
      const Wall& wall = s.walls[w];
      const double offset = wall.offset + (wall.moves ? wall.n.dot(plate) : 0);
      for (std::size_t i = 0; i < n; ++i)
        if (wall.n.dot(centre_of(s.beads[i])) - offset < s.beads[i].radius) {
          if (++touching[i] > 1) return false;
          pairs.emplace_back(static_cast<std::int32_t>(i), -1 - static_cast<std::int32_t>(w));
        }
    }
    bool crowded = false;
    const auto touch = [&](std::int32_t i, std::int32_t j) {
      crowded = crowded || ++touching[static_cast<std::size_t>(i)] > 1 ||
                ++touching[static_cast<std::size_t>(j)] > 1;
      pairs.emplace_back(i, j);
    };
    for_each_near_pair(s.beads, s.dimension, s.period, 0,
                       [&](std::int32_t i, std::int32_t j, double, const Vec3&) { touch(i, j); });
    // A contact in progress has a stretched spring, but collisions are integrated from an unstretched one.
    if (crowded || (plan_.history && !pairs.empty())) return false;
    begin_flights(s);
    for (const auto& [i, j] : pairs)
      if (!meet_now(i, j)) return give_up();
    for (std::size_t i = 0; i < n; ++i)
      if (!foresee(i)) return give_up();
    counted_ = counters();
    list_builds_ = list_builds();
    steps_.reset();
    return true;
  }
  bool give_up() {
    end_flights();
    return false;
  }
  void end_flights() {
    lines_.reset();
    open_.clear();
    clusters_.clear();
  }
  void begin_flights(const System& s) {
    const std::size_t n = s.beads.size();
    std::vector<double> radii;
    for (const Bead& b : s.beads) radii.push_back(b.radius);
    lines_.emplace(radii, s.dimension, s.period);
    gravity_ = s.gravity;
    walls_ = s.walls;
    axis_ = static_cast<Eigen::Index>(s.drive.axis);
    amplitude_ = s.drive.amplitude, omega_ = s.drive.omega;
    dt_ = s.dt, per_period_ = s.steps_per_period;
    base_ = s.step / per_period_ * per_period_;
    now_ = static_cast<double>(s.step - base_) * dt_;
    mass_.resize(n), turn_.resize(n), rim_.resize(n);
    events_.clear(n);
    open_.clear();
    clusters_.clear();
    frame_ = s;
    frame_.beads.clear(), frame_.forces.clear(), frame_.rim_speeds.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const Bead& b = s.beads[i];
      mass_[i] = b.mass;
      turn_[i] = b.radius * b.radius / b.inertia;
      fly_on(i, s, i, now_);
    }
  }

  [[nodiscard]] BallisticPath line_through(const Bead& b, double t) const {
    return BallisticPath::through(centre_of(b), Vec3(b.vx, b.vy, b.vz), t, gravity_);
  }
  /// From t on, bead i moves on the path of bead k of `s`.
  void fly_on(std::size_t i, const System& s, std::size_t k, double t) {
    const Bead& b = s.beads[k];
    rim_[i] = s.rim_speeds.size() == s.beads.size()
                  ? Vec3(s.rim_speeds[k])
                  : Vec3(b.radius * b.spin_x, -b.radius * b.spin, b.radius * b.spin_z);
    lines_->put(i, line_through(b, t));
    lines_->valid_from(i) = t;
  }

  // --- event-driven motion ---

  void fly(System& s, std::int64_t last) {
    const std::int64_t stop = std::min(last, base_ + per_period_);
    const double until = static_cast<double>(stop - base_) * dt_;
    for (;;) {
      const std::size_t i = events_.soonest();
      const Event next = events_[i];
      if (!(next.time < until)) break;
      now_ = std::max(now_, next.time);
      if (!happen(i, next)) {
        s.step = std::max(s.step, base_ + step_before(now_));
        if (disperse_crowd(s)) continue;
        pass_to_steps(s);
        return;
      }
    }
    now_ = until;
    s.step = stop;
    if (stop == base_ + per_period_) begin_period();
  }
  /// Moves the origin of time by one period and removes completed contacts and clusters.
  void begin_period() {
    const double period = static_cast<double>(per_period_) * dt_;
    base_ += per_period_;
    now_ -= period;
    std::erase_if(open_, [&](const Contact& c) { return c.until <= now_ + period; });
    std::erase_if(clusters_, [&](const ClusterRun& c) { return c.until <= now_ + period; });
    events_.set_back(period);
    for (std::size_t i = 0; i < lines_->size(); ++i) {
      lines_->put(i, (*lines_)[i].later(period, gravity_));
      lines_->valid_from(i) -= period;
    }
    for (Contact& c : open_) {
      c.begin -= period, c.middle -= period, c.end -= period, c.from -= period, c.until -= period;
      for (BallisticPath& line : c.before) line = line.later(period, gravity_);
    }
    for (ClusterRun& c : clusters_) {
      c.from -= period, c.until -= period;
      for (BallisticPath& line : c.before) line = line.later(period, gravity_);
    }
  }

  /// Handles an event. \returns false if three bodies meet; `cluster_` then contains some of them
  bool happen(std::size_t i, Event event) {
    switch (event.kind) {
      case Event::Kind::look_again:
        return foresee(i);
      case Event::Kind::wall:
        return meet_now(static_cast<std::int32_t>(i), event.partner) && foresee_anew(i, i);
      case Event::Kind::touch: {
        const auto j = static_cast<std::size_t>(event.partner);
        return meet_now(static_cast<std::int32_t>(std::min(i, j)),
                        static_cast<std::int32_t>(std::max(i, j))) &&
               foresee_anew(i, j);
      }
      case Event::Kind::none:
        break;
    }
    return true;
  }
  /// Finds the next events of two beads with new paths.
  bool foresee_anew(std::size_t i, std::size_t j) {
    events_.put(i, {}), events_.put(j, {});
    if (!foresee(i) || (j != i && !foresee(j))) return false;
    for (const std::size_t changed : {i, j}) events_.put_off(changed);
    return true;
  }

  /// Finds the next event of bead i on its present path. \returns false if three bodies meet
  bool foresee(std::size_t i) {
    const BallisticPaths::Hit hit = lines_->first_hit(i, now_);
    const double from = std::max(now_, lines_->valid_from(i));
    if (hit.overlap) {
      cluster_ = {static_cast<std::int32_t>(i)};
      const Passage here{cluster_.front(), (*lines_)[i], lines_->radius(i), from, from};
      add_near({&here, 1});
      return false;
    }
    Event event;
    if (hit.time < event.time) event = {hit.time, Event::Kind::touch, hit.partner};
    if (hit.until < event.time) event = {hit.until, Event::Kind::look_again, -1};
    for (std::size_t w = 0; w < walls_.size(); ++w) {
      if (in_wall(i, walls_[w], from)) {
        cluster_ = {static_cast<std::int32_t>(i)};
        return false;
      }
      if (const double t = wall_touch(i, walls_[w], from, event.time); t < event.time)
        event = {t, Event::Kind::wall, -1 - static_cast<std::int32_t>(w)};
    }
    cluster_ = {static_cast<std::int32_t>(i)};
    const Passage own{cluster_.front(), (*lines_)[i], lines_->radius(i), now_, HUGE_VAL};
    if (near_others_meeting(own, {&own, 1})) return false;
    events_.put(i, event);
    if (event.kind == Event::Kind::touch) {
      const auto other = static_cast<std::size_t>(event.partner);
      if (event.time < events_[other].time)
        events_.put(other, {event.time, Event::Kind::touch, static_cast<std::int32_t>(i)});
    }
    return true;
  }
  /// A bead on or near a path between two times.
  struct Passage {
    std::int32_t bead;
    BallisticPath line;
    double radius;  ///< radius of the bead plus its largest deviation from the path
    double begin, end;
  };
  /// Calls visit(bead) for each member of a contact or cluster.
  template <class Visit>
  static void visit_members(const Contact& c, Visit visit) {
    visit(c.i);
    if (c.j >= 0) visit(c.j);
  }
  template <class Visit>
  static void visit_members(const ClusterRun& c, Visit visit) {
    for (const std::int32_t k : c.cluster.members) visit(k);
  }
  /// Calls visit(passage) for the passages of these beads, until they are on their paths after the contact or
  /// cluster.
  template <class Visit>
  void visit_passages(const Contact& c, const std::array<BallisticPath, 2>& after, Visit visit) const {
    for (std::size_t q = 0; q < (c.j < 0 ? 1u : 2u); ++q) {
      const std::int32_t k = q == 0 ? c.i : c.j;
      const double radius = lines_->radius(static_cast<std::size_t>(k));
      visit(Passage{k, c.before[q], radius + c.early[q], c.from, c.middle});
      visit(Passage{k, after[q], radius + c.late[q], c.middle, c.until});
    }
  }
  template <class Visit>
  void visit_passages(const Contact& c, Visit visit) const {
    const auto line = [&](std::int32_t k) { return (*lines_)[static_cast<std::size_t>(std::max(0, k))]; };
    visit_passages(c, {line(c.i), line(c.j)}, visit);
  }
  template <class Visit>
  void visit_passages(const ClusterRun& c, Visit visit) const {
    for (std::size_t k = 0; k < c.cluster.members.size(); ++k) {
      const std::int32_t bead = c.cluster.members[k];
      const double radius = lines_->radius(static_cast<std::size_t>(bead));
      visit(Passage{bead, c.before[k], radius + c.cluster.stray[k], c.from, c.until});
    }
  }
  /// Calls visit(meeting) for contacts and clusters in progress.
  template <class Visit>
  void visit_meetings(Visit visit) const {
    for (const Contact& c : open_)
      if (c.until > now_) visit(c);
    for (const ClusterRun& c : clusters_)
      if (c.until > now_) visit(c);
  }
  [[nodiscard]] bool in_crowd(std::int32_t bead) const {
    return std::find(cluster_.begin(), cluster_.end(), bead) != cluster_.end();
  }
  /// A passage that encloses a contact or cluster from its beginning to its end.
  static Passage whole(const Contact& c) { return {c.i, c.before[0], c.about, c.from, c.until}; }
  static Passage whole(const ClusterRun& c) {
    return {c.cluster.members.front(), c.before.front(), HUGE_VAL, c.from, c.until};
  }
  /// For each contact or cluster without members in `cluster_`, adds one of its beads to `cluster_` if that
  /// bead may touch one of the passages from now on. \param all a passage that encloses all passages \returns
  /// whether a bead was added
  bool near_others_meeting(const Passage& all, std::span<const Passage> passages) {
    const std::size_t before = cluster_.size();
    const auto near = [&](const Passage& p, const Passage& q) {
      const double begin = std::max({now_, p.begin, q.begin}), end = std::min(p.end, q.end);
      return begin <= end && come_near(p, q, begin, end);
    };
    visit_meetings([&](const auto& meeting) {
      if (!near(all, whole(meeting))) return;
      bool own = false;
      visit_members(meeting, [&](std::int32_t k) { own = own || in_crowd(k); });
      if (own) return;
      std::int32_t found = -1;
      visit_passages(meeting, [&](const Passage& other) {
        if (std::any_of(passages.begin(), passages.end(), [&](const Passage& p) { return near(p, other); }))
          found = other.bead;
      });
      if (found >= 0) cluster_.push_back(found);
    });
    return cluster_.size() > before;
  }
  [[nodiscard]] double apart_at(const Passage& p, const Passage& q, double t) const {
    const Vec3 d = p.line.a - q.line.a + t * (p.line.b - q.line.b);
    return (d + lines_->shift(d)).norm();
  }
  [[nodiscard]] bool come_near(const Passage& p, const Passage& q, double begin, double end) const {
    const Vec3 w = p.line.b - q.line.b;
    Vec3 d = p.line.a - q.line.a + begin * w;
    d += lines_->shift(d);
    const double t = std::clamp(-d.dot(w) / std::max(w.squaredNorm(), 1e-300), 0.0, end - begin);
    const double reach = p.radius + q.radius;
    return (d + t * w).squaredNorm() < reach * reach;
  }
  /// Adds to `cluster_` the beads whose paths may touch one of the passages. The passages of one bead must be
  /// consecutive.
  /// \returns whether a bead was added
  bool add_near(std::span<const Passage> passages) {
    const std::size_t before = cluster_.size();
    while (!passages.empty()) {
      const Passage& first = passages.front();
      std::size_t own = 1;
      while (own < passages.size() && passages[own].bead == first.bead) ++own;
      add_near_one(passages.first(own));
      passages = passages.subspan(own);
    }
    return cluster_.size() > before;
  }
  void add_near_one(std::span<const Passage> passages) {
    // First a SIMD search for candidates: beads within a ball that contains all passages and moves along the
    // first path.
    const Passage &first = passages.front(), &last = passages.back();
    double reach = first.radius;
    for (const Passage& p : passages.subspan(1))
      for (const double t : {p.begin, p.end}) reach = std::max(reach, p.radius + apart_at(p, first, t));
    near_.clear();
    lines_->find_near(first.line, reach, first.begin, last.end, near_);
    for (const std::int32_t k : near_) {
      if (in_crowd(k)) continue;
      const auto i = static_cast<std::size_t>(k);
      const Passage other{k, (*lines_)[i], lines_->radius(i), 0, 0};
      if (std::any_of(passages.begin(), passages.end(),
                      [&](const Passage& p) { return come_near(p, other, p.begin, p.end); }))
        cluster_.push_back(k);
    }
  }

  [[nodiscard]] bool in_wall(std::size_t i, const Wall& wall, double t) const {
    const double above =
        wall.n.dot((*lines_)[i].position(t, gravity_)) - wall.offset - lines_->radius(i) + 1e-12;
    if (!wall.moves || above > std::abs(amplitude_)) return above < 0;
    return above < wall.n.dot(plate(t));
  }
  /// Time at which a bead on its path first touches a wall, from a time on. Infinite if it never does, or not
  /// before `needed`. The gap h(t) is a parabola minus a sine, and its curvature is bounded below by -m. The
  /// root x of h + h' x - m x^2/2 = 0 is therefore a step that never passes the first root of h, and the
  /// steps converge to it as fast as Newton's.
  [[nodiscard]] double wall_touch(std::size_t i, const Wall& wall, double from, double needed) const {
    const BallisticPath line = (*lines_)[i];
    const double height = wall.n.dot(line.a) - wall.offset - lines_->radius(i), speed = wall.n.dot(line.b),
                 fall = wall.n.dot(gravity_);
    const double swing = wall.moves ? amplitude_ * wall.n[axis_] : 0, most = std::abs(swing);
    const double bend = std::max(0.0, most * omega_ * omega_ - fall);
    double t = from;
    for (int k = 0; k < 200; ++k) {
      // No touch is possible until the parabola reaches the highest position of the wall.
      const double above = height + t * (speed + 0.5 * t * fall) - most, rise = speed + t * fall;
      if (above > 0) {
        const double down = first_zero(above, rise, fall);
        if (down == HUGE_VAL) return HUGE_VAL;
        t += down;
      }
      if (t >= needed) return HUGE_VAL;
      double sine = 0, cosine = 0;
      if (most > 0) sine = std::sin(omega_ * t), cosine = std::cos(omega_ * t);
      const double h = height + t * (speed + 0.5 * t * fall) - swing * sine;
      const double rate = speed + t * fall - swing * omega_ * cosine;
      if (h < 1e-14 && rate <= 0) return t;
      const double x = first_zero(std::max(0.0, h), rate, -bend);
      if (x == HUGE_VAL) return HUGE_VAL;
      if (t + x == t) return t;
      t += x;
    }
    return t;
  }
  /// The first x > 0 with c + b x + a x^2/2 = 0, for c > 0, or for c = 0 and b > 0; infinite if there is no
  /// such x.
  static double first_zero(double c, double b, double a) {
    const double inside = b * b - 2 * a * c;
    if (inside < 0) return HUGE_VAL;
    const double root = std::sqrt(inside);
    if (b < 0) return 2 * c / (root - b);
    return a < 0 ? (b + root) / -a : HUGE_VAL;
  }

  // --- binary collisions ---

  [[nodiscard]] CollisionSetting setting(std::int32_t i, std::int32_t j) const {
    const auto a = static_cast<std::size_t>(i);
    CollisionSetting e;
    e.dimension = plan_.dimension;
    const double m = mass_[a], r = lines_->radius(a);
    if (j < 0) {
      const Wall& wall = walls_[static_cast<std::size_t>(-1 - j)];
      e.laws = &plan_.wall_laws[static_cast<std::size_t>(-1 - j)];
      e.reach = r;
      e.turn = turn_[a];
      e.pair = {m, r, 1 / m + turn_[a]};
      e.wall = wall.n;
      e.pull = gravity_;
      if (wall.moves) e.swing[axis_] = amplitude_ * omega_ * omega_, e.omega = omega_;
    } else {
      const auto b = static_cast<std::size_t>(j);
      const double m_b = mass_[b], r_b = lines_->radius(b);
      e.laws = &plan_.bead;
      e.reach = r + r_b;
      e.turn = turn_[a] + turn_[b];
      e.pair = {m * m_b / (m + m_b), r * r_b / (r + r_b), 1 / m + 1 / m_b + turn_[a] + turn_[b]};
    }
    return e;
  }
  /// Plate displacement at a time of this period; plate_velocity() likewise.
  [[nodiscard]] Vec3 plate(double t) const {
    Vec3 d = Vec3::Zero();
    d[axis_] = amplitude_ * std::sin(omega_ * t);
    return d;
  }
  [[nodiscard]] Vec3 plate_velocity(double t) const {
    Vec3 v = Vec3::Zero();
    v[axis_] = amplitude_ * omega_ * std::cos(omega_ * t);
    return v;
  }
  /// A point of the surface of a wall, and its velocity.
  [[nodiscard]] std::pair<Vec3, Vec3> surface(const Wall& wall, double t) const {
    const Vec3 foot = wall.offset * wall.n;
    if (!wall.moves) return {foot, Vec3::Zero()};
    return {foot + plate(t), plate_velocity(t)};
  }

  /// States of both beads of a contact (of one, at a wall) from their relative motion at t.
  [[nodiscard]] std::array<Instant, 2> apart(const Contact& c, const RelativeMotion& m, double t) const {
    const auto i = static_cast<std::size_t>(c.i);
    std::array<Instant, 2> both{};
    if (c.j < 0) {
      const auto [point, speed] = surface(walls_[static_cast<std::size_t>(-1 - c.j)], t);
      both[0] = {point + m.r, speed + m.u, m.s};
      return both;
    }
    const auto j = static_cast<std::size_t>(c.j);
    const double share = mass_[i] / (mass_[i] + mass_[j]);
    const Vec3 r = share * c.before[0].position(t, gravity_) +
                   (1 - share) * (c.before[1].position(t, gravity_) - c.shift);
    const Vec3 v =
        share * c.before[0].velocity(t, gravity_) + (1 - share) * c.before[1].velocity(t, gravity_);
    const Vec3 turned = m.s - c.rim[0] - c.rim[1];
    const double part = turn_[i] / (turn_[i] + turn_[j]);
    both[0] = {r + (1 - share) * m.r, v + (1 - share) * m.u, c.rim[0] + part * turned};
    both[1] = {r - share * m.r + c.shift, v - share * m.u, c.rim[1] + (1 - part) * turned};
    return both;
  }

  /// Integrates a contact of two bodies that touch, or are in contact, now, to its end, and sets their paths
  /// after it.
  /// \returns false if the contact does not end or another body may touch one of the beads
  bool meet_now(std::int32_t i, std::int32_t j) {
    Contact c{};
    c.i = i, c.j = j;
    c.begin = now_;
    // Relative motion at the present time.
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(std::max(0, j));
    c.before = {(*lines_)[a], j < 0 ? BallisticPath{} : (*lines_)[b]};
    c.rim = {rim_[a], j < 0 ? Vec3::Zero().eval() : rim_[b]};
    const CollisionSetting e = setting(i, j);
    const Vec3 r = c.before[0].position(now_, gravity_), v = c.before[0].velocity(now_, gravity_);
    if (j < 0) {
      const auto [point, speed] = surface(walls_[static_cast<std::size_t>(-1 - j)], now_);
      c.motion = {r - point, v - speed, c.rim[0]};
    } else {
      c.motion.r = r - c.before[1].position(now_, gravity_);
      c.shift = lines_->shift(c.motion.r);
      c.motion.r += c.shift;
      c.motion.u = v - c.before[1].velocity(now_, gravity_);
      c.motion.s = c.rim[0] + c.rim[1];
    }
    // Integration. If the contact rests or is too deep, all beads are advanced by steps: `cluster_` stays
    // empty.
    const double speed = c.motion.u.norm();
    const CollisionEnd end = integrate_collision(
        e, c.motion, now_, now_ + kLongest * collision_time(e, std::max(speed, 1e-3)), kTolerance);
    cluster_.clear();
    if (!end.parted || end.deepest > limits_.overlap) return false;
    // Paths after the contact, and the deviations from both paths.
    c.end = end.time;
    c.from = static_cast<double>(step_before(c.begin)) * dt_;
    c.until = static_cast<double>(step_before(c.end) + 1) * dt_;
    c.middle = end.middle;
    const auto halfway = apart(c, end.at_middle, end.middle), after = apart(c, end.motion, end.time);
    std::array<BallisticPath, 2> lines{};
    for (std::size_t q = 0; q < (j < 0 ? 1u : 2u); ++q) {
      lines[q] = BallisticPath::through(after[q].r, after[q].v, c.end, gravity_);
      // The direction of the force changes little, so a bead moves ever farther from the path; the deviation
      // is largest at the middle.
      const auto off = [&](const BallisticPath& line) {
        return 1.05 * (halfway[q].r - line.position(c.middle, gravity_)).norm();
      };
      c.early[q] = off(c.before[q]), c.late[q] = off(lines[q]);
    }
    // Third bodies: any bead, contact, cluster or wall that the beads may touch while they are in contact.
    cluster_ = {i};
    if (j >= 0) cluster_.push_back(j);
    passages_.clear();
    visit_passages(c, lines, [&](const Passage& p) {
      passages_.push_back(p);
      passages_.back().begin = std::max(p.begin, now_);
    });
    for (const Passage& p : passages_)
      for (const double t : {p.begin, p.end})
        c.about = std::max(c.about, p.radius + apart_at(p, passages_.front(), t));
    bool alone = !add_near(passages_);
    alone = !near_others_meeting(whole(c), passages_) && alone;
    // A bead in contact with another body and near a wall counts as three bodies too.
    for (std::size_t w = 0; w < walls_.size(); ++w)
      if (j != -1 - static_cast<std::int32_t>(w) && reaches(whole(c), walls_[w]))
        alone = alone && std::none_of(passages_.begin(), passages_.end(),
                                      [&](const Passage& p) { return reaches(p, walls_[w]); });
    if (!alone) return false;
    // Accepted: the paths after the contact become the present ones.
    lines_->put(a, lines[0]);
    lines_->valid_from(a) = c.until;
    rim_[a] = after[0].rim;
    if (j >= 0) {
      lines_->put(b, lines[1]);
      lines_->valid_from(b) = c.until;
      rim_[b] = after[1].rim;
    }
    std::erase_if(open_, [&](const Contact& old) { return old.until <= now_; });
    open_.push_back(c);
    return true;
  }
  /// Whether a body may touch a wall during a passage, which must be short.
  [[nodiscard]] bool reaches(const Passage& p, const Wall& wall) const {
    const double span = p.end - p.begin, swing = wall.moves ? std::abs(amplitude_) : 0;
    const double bend = gravity_.norm() + swing * omega_ * omega_, sag = 0.125 * bend * span * span;
    const auto height = [&](double t) {
      return wall.n.dot(p.line.position(t, gravity_)) - wall.offset - p.radius;
    };
    const double begin = height(p.begin), end = height(p.end);
    if (std::min(begin, end) > swing + sag) return false;
    const auto rise = [&](double t) { return wall.moves ? wall.n.dot(plate(t)) : 0; };
    return std::min(begin - rise(p.begin), end - rise(p.end)) < sag;
  }

  // --- clusters ---

  /// Extracts a cluster at the present step of the system (the beads of `cluster_`, the beads in contact with
  /// them, and the beads that may touch them) and advances it by time steps until its beads have parted.
  /// \returns false if they do not part or are too many; the contacts are then unchanged
  bool disperse_crowd(System& s) {
    if (cluster_.empty()) return false;
    write(s);
    const double from = static_cast<double>(s.step - base_) * dt_;
    const auto contact = std::max<std::int64_t>(1, std::llround(plan_.shortest().time / dt_));
    std::vector<std::int32_t> members;
    for (;;) {
      const std::vector<std::int32_t> more = cluster_;
      cluster_ = members;
      for (const std::int32_t k : more)
        if (!in_crowd(k)) cluster_.push_back(k);
      add_partners(from);
      if (cluster_.size() == members.size() || cluster_.size() > kMostInCrowd) return false;
      members = cluster_;
      std::sort(cluster_.begin(), cluster_.end());
      ClusterRun c{take_out(s, memories_, cluster_), from, 0, {}};
      const auto end =
          disperse(c.cluster, contact, static_cast<std::int64_t>(kLongest) * contact, make_steps_.few);
      if (!end) return false;
      c.until = static_cast<double>(s.step + c.cluster.steps - base_) * dt_;
      for (const Bead& b : c.cluster.start.beads) c.before.push_back(line_through(b, from));
      passages_.clear();
      visit_passages(c, [&](const Passage& p) { passages_.push_back(p); });
      bool alone = !add_near(passages_);
      alone = !near_others_meeting(whole(c), passages_) && alone;
      if (alone && start_flight(std::move(c), *end)) return true;
    }
  }
  /// Adds to `cluster_` every bead in contact, or in a cluster, with a bead of `cluster_`.
  void add_partners(double from) {
    for (bool grown = true; grown;) {
      grown = false;
      const auto take_all = [&](const auto& meeting) {
        bool own = false;
        visit_members(meeting, [&](std::int32_t k) { own = own || in_crowd(k); });
        if (!own || meeting.until <= from) return;
        visit_members(meeting, [&](std::int32_t k) {
          if (!in_crowd(k)) cluster_.push_back(k), grown = true;
        });
      };
      for (const Contact& c : open_) take_all(c);
      for (const ClusterRun& c : clusters_) take_all(c);
    }
  }
  /// Sets the paths of the members after their cluster. \returns false if they then meet other bodies at
  /// once; `cluster_` contains some of these
  bool start_flight(ClusterRun crowd, const System& end) {
    const std::vector<std::int32_t> members = crowd.cluster.members;
    const auto within = [&](std::int32_t k) { return std::binary_search(members.begin(), members.end(), k); };
    std::erase_if(open_, [&](const Contact& c) { return c.until > crowd.from && within(c.i); });
    std::erase_if(clusters_, [&](const ClusterRun& c) {
      return c.until > crowd.from && within(c.cluster.members.front());
    });
    for (std::size_t k = 0; k < members.size(); ++k) {
      const auto i = static_cast<std::size_t>(members[k]);
      fly_on(i, end, k, crowd.until);
      events_.put(i, {});
    }
    clusters_.push_back(std::move(crowd));
    for (const std::int32_t k : members)
      if (!foresee(static_cast<std::size_t>(k))) return false;
    for (const std::int32_t k : members) events_.put_off(static_cast<std::size_t>(k));
    return true;
  }

  // --- beads and forces at a step, and the change to time steps ---

  /// The last whole step, counted from the start of this period, at or before a time.
  [[nodiscard]] std::int64_t step_before(double t) const {
    auto k = static_cast<std::int64_t>(std::floor(t / dt_));
    if (static_cast<double>(k + 1) * dt_ <= t) ++k;
    if (static_cast<double>(k) * dt_ > t) --k;
    return k;
  }
  /// Writes beads and contact forces at the present step of the system.
  void write(System& s) {
    const double t = static_cast<double>(s.step - base_) * dt_;
    const auto put = [&](std::size_t i, const Instant& at) {
      Bead& b = s.beads[i];
      b.x = at.r.x(), b.y = at.r.y(), b.z = at.r.z();
      b.vx = at.v.x(), b.vy = at.v.y(), b.vz = at.v.z();
      b.spin_x = at.rim.x() / b.radius, b.spin = -at.rim.y() / b.radius, b.spin_z = at.rim.z() / b.radius;
    };
    const auto flown = [&](const BallisticPath& line, const Vec3& rim) {
      return Instant{line.position(t, gravity_), line.velocity(t, gravity_), rim};
    };
    s.rim_speeds.clear();
    s.forces.assign(s.beads.size(), {});
    s.forces_known = true;
    memories_.clear();
    for (std::size_t i = 0; i < s.beads.size(); ++i) put(i, flown((*lines_)[i], rim_[i]));
    // The paths are those after a contact; beads still in contact need its integration.
    for (const Contact& c : open_) {
      if (t < c.from || t >= c.end) continue;
      std::array<Instant, 2> both{};
      if (t <= c.begin) {
        for (std::size_t q = 0; q < 2; ++q) both[q] = flown(c.before[q], c.rim[q]);
        if (t == c.begin) write_contact(s, c, c.motion, Vec3::Zero(), t);
      } else {
        const CollisionEnd now = integrate_collision(setting(c.i, c.j), c.motion, c.begin, t, kTolerance);
        both = apart(c, now.motion, t);
        write_contact(s, c, now.motion, now.xi, t);
      }
      put(static_cast<std::size_t>(c.i), both[0]);
      if (c.j >= 0) put(static_cast<std::size_t>(c.j), both[1]);
    }
    for (const ClusterRun& c : clusters_) {
      if (s.step - c.cluster.start.step >= c.cluster.steps) continue;
      const ClusterState now = after(c.cluster, s.step - c.cluster.start.step, make_steps_.few);
      for (std::size_t k = 0; k < c.cluster.members.size(); ++k) {
        const auto i = static_cast<std::size_t>(c.cluster.members[k]);
        s.beads[i] = now.system.beads[k];
        s.forces[i] = now.system.forces[k];
      }
      for (ContactMemory m : now.memories) {
        m.i = c.cluster.members[static_cast<std::size_t>(m.i)];
        if (m.j >= 0) m.j = c.cluster.members[static_cast<std::size_t>(m.j)];
        memories_.push_back(std::move(m));
      }
    }
    std::sort(memories_.begin(), memories_.end(), [](const ContactMemory& a, const ContactMemory& b) {
      return std::pair(a.i, a.j) < std::pair(b.i, b.j);
    });
  }
  void write_contact(System& s, const Contact& c, const RelativeMotion& m, const Vec3& xi, double t) {
    const CollisionSetting e = setting(c.i, c.j);
    const CollisionForce f = force_of(e, m, xi);
    const auto add = [&](std::int32_t bead, double sign) {
      Force& to = s.forces[static_cast<std::size_t>(bead)];
      to.x += sign * f.force.x(), to.y += sign * f.force.y(), to.z += sign * f.force.z();
      to.q_x += f.moment.x(), to.q -= f.moment.y(), to.q_z += f.moment.z();
    };
    add(c.i, 1);
    if (c.j >= 0) add(c.j, -1);
    ContactMemory memory{c.i, c.j, {}};
    // A tangential vector; in 2D only its component along (-n_z, n_x).
    const auto remember = [&](const Vec3& along) {
      if (plan_.dimension == 2)
        memory.values.push_back(-along.x() * f.normal.z() + along.z() * f.normal.x());
      else
        memory.values.insert(memory.values.end(), {along.x(), along.y(), along.z()});
    };
    if (plan_.history) remember(xi);
    if (plan_.key.velocity == Velocity::half_step) {
      if (plan_.history) memories_.push_back(std::move(memory));
      return;
    }
    // The contact memory that a preceding step would have left: the velocities in the middle of that step.
    const double half = 0.5 * dt_;
    RelativeMotion middle = m;
    Vec3 push = f.force / e.pair.m_eff + e.pull + e.swing * std::sin(e.omega * t);
    middle.u -= half * push;
    middle.s += half * e.turn * f.moment;
    const double v_n = middle.u.dot(f.normal);
    memory.values.push_back(v_n);
    if (plan_.rotation) remember(middle.u - v_n * f.normal - middle.s.cross(f.normal));
    memories_.push_back(std::move(memory));
  }
  /// Changes from event-driven motion to time steps.
  void pass_to_steps(System& s) {
    write(s);
    end_flights();
    steps_ = make_steps_.all();
    steps_->restore(memories_);
    wait_ = look_every_;
    next_look_ = (s.step / wait_ + 1) * wait_;
  }

  Plan plan_;
  GuardLimits limits_;
  std::int64_t look_every_;
  SteppingSolvers make_steps_;
  std::unique_ptr<Solver> steps_;  ///< exists while time steps are used
  std::int64_t next_look_ = 0, wait_ = 1;
  Counters counted_;
  std::int64_t list_builds_ = 0;

  /// Exists during event-driven motion. Times count from the start of the period.
  std::optional<BallisticPaths> lines_;
  EventQueue events_;
  std::vector<Contact> open_;
  std::vector<ClusterRun> clusters_;
  std::vector<std::int32_t> cluster_;  ///< beads just found to form a cluster
  std::vector<std::int32_t> near_;     ///< buffer of add_near_one()
  std::vector<Passage> passages_;      ///< buffer: passages of the contact or cluster being added
  System frame_;                       ///< without beads: walls, drive, period
  std::vector<Vec3> rim_;              ///< R w, after the present contact
  std::vector<double> mass_, turn_;    ///< turn: R^2/I
  std::vector<Wall> walls_;
  Vec3 gravity_ = Vec3::Zero();
  Eigen::Index axis_ = 2;
  double amplitude_ = 0, omega_ = 0, dt_ = 0, now_ = 0;
  std::int64_t per_period_ = 1, base_ = 0;  ///< base_: step at which the period began

  std::vector<ContactMemory> memories_;
  std::vector<Bead> left_;  ///< as at the end of the last call
  std::int64_t left_step_ = -1;
  double left_amplitude_ = 0;
};

}  // namespace

std::unique_ptr<Solver> make_event_driven_solver(const Plan& plan, const GuardLimits& limits,
                                                 SteppingSolvers steps) {
  return std::make_unique<EventDrivenSolver>(plan, limits, std::move(steps));
}

}  // namespace twincell::sim
