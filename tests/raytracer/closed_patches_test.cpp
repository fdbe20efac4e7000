// Nothing gets through a closed mesh of n-sided patches. Lines enter as often as they leave, in turn where the mesh is a ball; rays aimed
// at where charts, patches and the cells of their splines meet find what they are aimed at; rays that leave the surface neither meet it
// again where they start nor get out of it. $ISOPHOTE_RAYS sets the number of rays per mesh of the slow suite.
#include "raytracer/tracer.h"
#include "tests/support/patch_meshes.h"
#include "tests/support/paths.h"
#include "tests/support/random_shapes.h"
#include "tests/support/residuals.h"
#include "tests/support/solids.h"
#include "tests/support/told.h"
#include "tests/support/wanted.h"

namespace iso::test {
namespace {

constexpr std::uint64_t kSeed = 20261122;
constexpr std::uint64_t kChunk = 4096;
// Sizes: how far from its target a hit may lie, over the cosine: rounding of rays that start two sizes away.
constexpr double kNear = 1e-14;
// Sizes: what a ray that leaves meets so near to its start is not told from the start by its length.
constexpr double kTwice = 1e-9;
// Sizes: so near to a vertex the charts about it are one plane, since what they bend over that distance is below rounding; where they fold
// there, nothing tells one sheet from another.
constexpr double kAtVertex = 1e-8;
// Below this cosine a target is not aimed at, and a hit says nothing about sides.
constexpr double kGrazing = kGrazingCosine;

struct Found {
  std::uint64_t lines = 0, met = 0, hits = 0, doubles = 0, odd = 0, touching = 0, at_folds = 0, unbalanced = 0, not_in_turn = 0, astray = 0;
  std::uint64_t aimed = 0, missed = 0, missed_window = 0, without_normal = 0;
  std::uint64_t leaving = 0, inward = 0, flat = 0, leaked = 0, at_start = 0;
  Residuals residuals;
  SolverStats stats;
  Told told;

  void add(const Found& o) {
    for (std::uint64_t Found::*m :
         {&Found::lines, &Found::met, &Found::hits, &Found::doubles, &Found::odd, &Found::touching, &Found::at_folds, &Found::unbalanced,
          &Found::not_in_turn, &Found::astray, &Found::aimed, &Found::missed, &Found::missed_window, &Found::without_normal,
          &Found::leaving, &Found::inward, &Found::flat, &Found::leaked, &Found::at_start})
      this->*m += o.*m;
    residuals.add(o.residuals);
    stats += o.stats;
    told.add(o.told);
  }
};

class Subject {
 public:
  Subject(std::string name, const PolygonMesh& mesh, MeshKind kind, bool ball, Edges edges = Edges::none)
      : name_(std::move(name)), tracer_(scene_of(patches_over(mesh, kind), edges)), ball_(ball) {
    const Box3 box = tracer_.scene().box();
    size_ = box.diagonal();
    middle_ = box.middle();
    for (const Face& face : faces()) error_ = std::max(error_, std::get<PatchChart>(face.surface).error);
    flat_ = 4 * std::sqrt(error_ / size_);
  }

  void examine(std::uint64_t rays) const {
    const std::uint64_t chunks = (rays + 3 * kChunk - 1) / (3 * kChunk);
    Found sums[2];
    in_chunks(chunks, [&](std::uint64_t c, std::uint64_t thread) {
      Random random(kSeed + c);
      through(random, sums[thread]);
      aimed(random, sums[thread]);
      leaving(random, sums[thread]);
    });
    Found f = sums[0];
    f.add(sums[1]);
    tell(f, chunks);
  }

  // Lines that were once counted wrong.
  void examine_lines(const std::vector<Ray>& lines) const {
    Found f;
    follow(lines, f);
    EXPECT_EQ(f.lines, lines.size());
    EXPECT_EQ(f.met, f.lines) << name_;
    EXPECT_EQ(f.unbalanced, 0u) << name_;
    EXPECT_EQ(f.astray, 0u) << name_;
    f.residuals.finish(name_);
    f.told.fail(name_);
  }

  // Rays that once missed what they are aimed at, and how far away that is.
  struct Aimed {
    Ray ray;
    double target;
  };
  void examine_targets(const std::vector<Aimed>& all) const {
    std::vector<Hit> hits;
    std::vector<std::size_t> offsets;
    SolverStats stats;
    for (const Aimed& aimed : all) {
      tracer_.all({&aimed.ray, 1}, hits, offsets, stats);
      const auto is_met = [&](const Hit& hit) {
        return std::abs((hit.t - aimed.target) * cosine_at(tracer_, hit, aimed.ray)) <= 8 * kNear * size_;
      };
      EXPECT_TRUE(std::any_of(hits.begin(), hits.end(), is_met)) << name_ << ": " << text_of_line(aimed.ray, hits);
    }
  }

 private:
  const Placed& placed() const { return tracer_.scene().placed.front(); }
  const std::vector<Face>& faces() const { return placed().part->faces; }

  // Lines through a random place in the box.
  void through(Random& random, Found& f) const {
    std::vector<Ray> rays;
    for (std::uint64_t i = 0; i < kChunk; ++i) {
      const Vec3 d = random_direction(random), at = middle_ + 0.35 * size_ * std::cbrt(between(random, 0, 1)) * random_direction(random);
      rays.push_back({at - 2 * size_ * d, d});
    }
    follow(rays, f);
  }

  // The hits that charts have in common counted once: at one distance, in the same sense, both on the border of their chart or at a vertex.
  // +1 where the line enters, -1 where it leaves. Not told: a hit that touches, which may stand for either or for none; and a vertex that
  // is met in both senses, since the charts about it fold there: as sectors of one plane that close up around it they cover what lies
  // beside it once in all, in the one sense or the other, or not at all.
  struct Senses {
    int sum = 0, touching = 0, at_folds = 0;
    std::uint64_t doubles = 0;
    bool in_turn = true;

    bool balanced() const { return std::abs(sum) <= touching + at_folds; }
  };
  // Hits kept so far.
  struct Kept {
    double t;
    int sense;
    bool on_border, at_vertex;
  };
  Senses senses_of(const Ray& ray, std::span<const Hit> hits, Found& f) const {
    Senses s;
    std::vector<Kept> kept;
    for (const Hit& hit : hits) {
      const SurfacePoint at = tracer_.surface_point(hit);
      const double cosine = glm::dot(at.n, ray.d);
      measure(ray, hit, cosine, f);
      if (hit.status == HitStatus::tangent) {
        ++s.touching;
        continue;
      }
      const int sense = cosine < 0 ? 1 : -1;
      const double near = kMostResidual * size_ / std::max(std::abs(cosine), kGrazing);
      const bool on_border = is_on_border(ray, hit, at), at_vertex = is_at_vertex(hit.uv, at);
      bool twice = false;
      for (Kept& k : kept) {
        if (hit.t - k.t >= near) continue;
        if (at_vertex && k.at_vertex && k.sense != sense) {
          twice = true;
          s.at_folds += k.sense != 0;
          s.sum -= k.sense;
          k.sense = 0;
        }
        twice = twice || (k.sense == sense && ((on_border && k.on_border) || (at_vertex && k.at_vertex)));
      }
      if (twice) {
        ++s.doubles;
        continue;
      }
      s.in_turn = s.in_turn && sense == (kept.empty() ? 1 : -kept.back().sense);
      s.sum += sense;
      kept.push_back({hit.t, sense, on_border, at_vertex});
    }
    return s;
  }

  // All hits of lines: as many in as out.
  void follow(const std::vector<Ray>& rays, Found& f) const {
    std::vector<Hit> hits;
    std::vector<std::size_t> offsets;
    tracer_.all(rays, hits, offsets, f.stats);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const std::span<const Hit> mine(hits.data() + offsets[i], offsets[i + 1] - offsets[i]);
      const Senses senses = senses_of(rays[i], mine, f);
      ++f.lines;
      f.met += !mine.empty();
      f.hits += mine.size();
      f.doubles += senses.doubles;
      f.odd += mine.size() % 2;
      f.touching += senses.touching > 0;
      f.not_in_turn += !senses.in_turn;
      f.at_folds += senses.at_folds > 0;
      if (senses.balanced() && (senses.in_turn || senses.touching || !ball_)) continue;
      ++f.unbalanced;
      f.told.add([&] { return text_of_line(rays[i], mine); });
    }
  }

  // A ray that touches passes the chart at the distance of its spline at most.
  void measure(const Ray& ray, const Hit& hit, double cosine, Found& f) const {
    if (hit.status != HitStatus::tangent) return f.residuals.add(tracer_, ray, hit, cosine, size_);
    const double off = glm::length(ray.o + hit.t * ray.d - tracer_.surface_point(hit).p);
    if (off <= std::get<PatchChart>(tracer_.face(hit).surface).error + kMostResidual * size_) return;
    ++f.astray;
    f.told.add([&] { return fmt::format("touches {:.3g} of the size away: {}", off / size_, text_of_line(ray, {&hit, 1})); });
  }

  // As the line sees it, by rounding: (s, t) of a hit where the chart is steep or small may be off by much more.
  bool seen_near(const Ray& ray, const Vec3& away, double near = kMostResidual) const {
    return glm::length(across(ray, away)) <= near * size_;
  }
  static Vec3 across(const Ray& ray, const Vec3& v) { return v - glm::dot(v, ray.d) * ray.d; }

  // Whether a border of the chart passes the line: at the place straight beside the hit, or at the one that the line sees nearest. Where
  // patches fold, tangents are along each other to 1e-4, and by rounding a line meets a chart 1e-9 of it away from the border that it is
  // aimed at. So both charts beside the border are met there, as the reference (patch_intersector.h) meets them: that is one crossing.
  bool is_on_border(const Ray& ray, const Hit& hit, const SurfacePoint& at) const {
    for (const int c : {0, 1})
      for (const double border : {0.0, 1.0}) {
        const Vec3 to = (border - hit.uv[c]) * (c == 0 ? at.Su : at.Sv), along = across(ray, c == 0 ? at.Sv : at.Su);
        if (seen_near(ray, to)) return true;
        const double length = glm::length(along);
        if (!(length > 0) || glm::length(glm::cross(across(ray, to), along)) > 2 * kNear * size_ * length) continue;
        Vec2 st{border};
        st[1 - c] = std::clamp(hit.uv[1 - c] - glm::dot(to, along) / (length * length), 0.0, 1.0);
        if (seen_near(ray, placed().to_world.point(point(tracer_.face(hit).surface, st)) - at.p, kNear)) return true;
      }
    return false;
  }
  bool is_at_vertex(const Vec2& st, const SurfacePoint& at) const {
    return glm::length(st) < 0.5 && glm::length(st.x * at.Su + st.y * at.Sv) <= kAtVertex * size_;
  }

  std::string text_of_line(const Ray& ray, std::span<const Hit> hits) const {
    std::string text = text_of(ray);
    for (const Hit& hit : hits)
      text += fmt::format(" [face {} t {:.17g} st {:.17g} {:.17g} n.d {:.3g} status {}]", hit.face, hit.t, hit.uv.x, hit.uv.y,
                          glm::dot(tracer_.surface_point(hit).n, ray.d), int(hit.status));
    return text;
  }

  // A place of a chart: its corner, the patch's centre, a border of the patch or between charts, a line of the spline's cells.
  static Vec2 special_place(const Face& face, Random& random) {
    const std::vector<double>& lines = std::get<PatchChart>(face.surface).near->knots_u;
    const auto line = [&] { return lines[random() % lines.size()]; };
    Vec2 st = point_in(random, {Vec2(0.0), Vec2(1.0)});
    const int c = whole(random, 0, 1);
    switch (whole(random, 0, 7)) {
      case 0:
        return {0, 0};
      case 1:
        return {1, 1};
      case 2:
      case 3:
        st[c] = 0;
        return st;
      case 4:
        st[c] = 1;
        return st;
      case 5:
        // Beside the corner, as near as rounding.
        return std::pow(10.0, between(random, -16, -2)) * st;
      default:
        st[c] = line();
        if (whole(random, 0, 1)) st[1 - c] = line();
        return st;
    }
  }

  // Rays at such places, with an open end and as a window about the target; every other one as a whole line.
  void aimed(Random& random, Found& f) const {
    std::vector<Ray> open, window, lines;
    std::vector<double> targets, reach;
    while (open.size() < kChunk) {
      const Face& face = faces()[random() % faces().size()];
      const Vec2 st = special_place(face, random);
      const Vec3 n = unit_normal(face.surface, st, face.domain), p = placed().to_world.point(point(face.surface, st));
      if (!finite(n) || n == Vec3(0.0)) {
        ++f.without_normal;
        continue;
      }
      const Vec3 d = random_direction(random);
      const double cosine = std::abs(glm::dot(d, n));
      if (cosine < kGrazing) continue;
      const double distance = size_ * (whole(random, 0, 1) ? 2 : std::pow(10.0, between(random, -5, -1)));
      const double near = 8 * kNear * size_ / cosine;
      open.push_back({p - distance * d, d});
      window.push_back({p - distance * d, d, distance - near, distance + near});
      if (distance > size_) lines.push_back(open.back());
      targets.push_back(distance);
      reach.push_back(near);
    }
    std::vector<Hit> first(open.size()), at(open.size());
    tracer_.nearest(open, first, Tracer::Order::scattered, f.stats);
    tracer_.nearest(window, at, Tracer::Order::coherent, f.stats);
    for (std::size_t i = 0; i < open.size(); ++i) {
      ++f.aimed;
      if (!first[i] || first[i].t > targets[i] + reach[i]) {
        ++f.missed;
        f.told.add([&] { return fmt::format("missed: target t {:.17g}, hit t {:.17g}, {}", targets[i], first[i].t, text_of(open[i])); });
      }
      if (!at[i]) {
        ++f.missed_window;
        f.told.add([&] { return fmt::format("nothing at the target, t {:.17g} +- {:.2g}, {}", targets[i], reach[i], text_of(open[i])); });
      } else {
        measure(window[i], at[i], cosine_at(tracer_, at[i], window[i]), f);
      }
    }
    follow(lines, f);
  }

  // Rays that leave the surface at a hit.
  void leaving(Random& random, Found& f) const {
    std::vector<Ray> rays;
    for (std::uint64_t i = 0; i < kChunk; ++i) {
      const Face& face = faces()[random() % faces().size()];
      const Vec2 st = whole(random, 0, 1) ? special_place(face, random) : point_in(random, {Vec2(0.0), Vec2(1.0)});
      const Vec3 p = placed().to_world.point(point(face.surface, st)), d = random_direction(random);
      rays.push_back({p - 2 * size_ * d, d});
    }
    std::vector<Hit> hits(rays.size());
    tracer_.nearest(rays, hits, Tracer::Order::scattered, f.stats);
    std::vector<Ray> away, lines;
    std::vector<Hit> starts;
    std::vector<double> steep;
    for (const Hit& hit : hits) {
      if (!hit) continue;
      const SurfacePoint at = tracer_.surface_point(hit);
      if (!ball_ && is_at_vertex(hit.uv, at)) continue;
      if (!finite(at.n) || at.n == Vec3(0.0)) {
        ++f.without_normal;
        continue;
      }
      const Vec3 d = random_direction(random);
      starts.push_back(hit);
      away.push_back(secondary_ray(hit, at, d));
      lines.push_back({at.p - 3 * size_ * d, d, 3 * size_ - kTwice * size_ * 1e-3});
      steep.push_back(glm::dot(d, at.n));
    }
    compare_with_lines(away, lines, starts, steep, f);
  }

  // Whether two hits of a line may be one, as it sees them.
  bool one_place(const Ray& ray, const Hit& a, const Hit& b) const {
    const SurfacePoint at = tracer_.surface_point(a), other = tracer_.surface_point(b);
    const Vec2 apart = b.uv - a.uv;
    if (a.face == b.face && seen_near(ray, apart.x * at.Su + apart.y * at.Sv)) return true;
    return is_on_border(ray, a, at) && is_on_border(ray, b, other);
  }

  // A ray that leaves the surface meets what the line through its start meets beyond it, and nothing else. Where sheets lie so close that
  // the lengths do not tell them from the start, the line must meet the ray's hit, too, and at another place than the start.
  void compare_with_lines(const std::vector<Ray>& away, const std::vector<Ray>& lines, const std::vector<Hit>& starts,
                          const std::vector<double>& steep, Found& f) const {
    std::vector<Hit> next(away.size()), all;
    std::vector<std::size_t> offsets;
    tracer_.nearest(away, next, Tracer::Order::scattered, f.stats);
    tracer_.all(lines, all, offsets, f.stats);
    for (std::size_t i = 0; i < away.size(); ++i) {
      ++f.leaving;
      f.inward += steep[i] < 0;
      // A ray that dips below the surface by less than the charts' splines stray may miss them.
      if (std::abs(steep[i]) < flat_) {
        ++f.flat;
        continue;
      }
      const double start = 3 * size_, near = kTwice * size_ / std::abs(steep[i]);
      double beyond = kInf;
      for (std::size_t k = offsets[i]; k < offsets[i + 1]; ++k)
        if (all[k].t > start + near) beyond = std::min(beyond, all[k].t - start);
      const double met = next[i] ? next[i].t : kInf;
      const bool close = met < near && std::any_of(all.begin() + static_cast<std::ptrdiff_t>(offsets[i]),
                                                   all.begin() + static_cast<std::ptrdiff_t>(offsets[i + 1]), [&](const Hit& hit) {
                                                     return hit.face == next[i].face && one_place(lines[i], hit, next[i]) &&
                                                            !one_place(lines[i], starts[i], next[i]);
                                                   });
      const bool lost = met > beyond + near, again = !close && met < beyond - near, out = ball_ && steep[i] < 0 && !next[i];
      f.leaked += lost || out;
      f.at_start += again;
      if (lost || again || out)
        f.told.add([&] {
          return fmt::format("leaves at n.d {:.3g}, meets {:.17g}, expected {:.17g}: {}", steep[i], met, beyond, text_of(away[i]));
        });
    }
  }

  void tell(const Found& f, std::uint64_t chunks) const {
    fmt::print(
        "[ measured ] {}: {} charts; {} lines, {} meet it, {} hits; {} doubles, {} odd; {} touch, {} meet a vertex where patches fold; "
        "unbalanced {}, not "
        "in turn {}; {} aimed, "
        "missed {}, in a window {}; {} leave, {} inward, {} flatter than {:.2g}: got out {}, met their start {}; {} fallbacks, {} "
        "touching, {} out of budget\n",
        name_, faces().size(), f.lines, f.met, f.hits, f.doubles, f.odd, f.touching, f.at_folds, f.unbalanced, f.not_in_turn, f.aimed,
        f.missed, f.missed_window, f.leaving, f.inward, f.flat, flat_, f.leaked, f.at_start, f.stats.fallbacks, f.stats.tangent,
        f.stats.fallback_out_of_budget);
    f.residuals.finish(name_);
    EXPECT_GE(f.lines, chunks * kChunk) << name_;
    EXPECT_GE(f.met, f.lines / 10) << name_;
    EXPECT_EQ(f.aimed, chunks * kChunk) << name_;
    EXPECT_GE(f.inward, chunks * kChunk / 4) << name_;
    EXPECT_LE(f.flat, f.leaving / 30) << name_;
    EXPECT_EQ(f.without_normal, 0u) << name_;
    EXPECT_EQ(f.unbalanced, 0u) << name_;
    EXPECT_EQ(f.astray, 0u) << name_;
    if (ball_) {
      EXPECT_LE(f.not_in_turn, f.touching) << name_;
      EXPECT_EQ(f.at_folds, 0u) << name_;
    }
    EXPECT_LE(f.touching, f.lines / 5000) << name_;
    EXPECT_EQ(f.missed, 0u) << name_;
    EXPECT_EQ(f.missed_window, 0u) << name_;
    EXPECT_EQ(f.leaked, 0u) << name_;
    EXPECT_EQ(f.at_start, 0u) << name_;
    f.told.fail(name_);
  }

  std::string name_;
  Tracer tracer_;
  bool ball_;  // where it is not, patches may fold over at a vertex
  double size_ = 0, error_ = 0, flat_ = 0;
  Vec3 middle_{0.0};
};

struct MeshFile {
  const char *name, *file;
  bool ball;  // round enough for every line to enter and leave in turn
};
constexpr MeshFile kMeshes[] = {{"TruncatedCuboctahedron", "truncated-cuboctahedron.obj", true},
                                {"SpotControlMesh", "spot-control-mesh.obj", false},
                                {"Goldberg", "goldberg-642.obj", true}};

void examine_file(const MeshFile& mesh, MeshKind kind, std::uint64_t rays) {
  constexpr const char* kKinds[] = {"", ", Charrot-Gregory", ", mean value", ", Charrot-Gregory by mean value"};
  Subject(std::string(mesh.name) + kKinds[static_cast<int>(kind)], read_polygons(data(std::string("meshes/") + mesh.file)), kind, mesh.ball)
      .examine(rays);
}

TEST(ClosedPatches, NothingGetsThroughSquaresAndHexagons) {
  for (const MeshKind kind : {MeshKind::gregory, MeshKind::charrot_gregory})
    for (const Edges edges : {Edges::none, Edges::shared})
      Subject("truncated octahedron", truncated_octahedron(), kind, true, edges).examine(25000);
}
TEST(ClosedPatches, NothingGetsThroughSquaresHexagonsAndOctagons) {
  for (const MeshKind kind : {MeshKind::gregory, MeshKind::charrot_gregory}) examine_file(kMeshes[0], kind, 50000);
}
// Their tangents have no limits at the corners.
TEST(ClosedPatches, NothingGetsThroughParametersByMeanValue) {
  for (const MeshKind kind : {MeshKind::gregory_mean_value, MeshKind::charrot_gregory_mean_value}) examine_file(kMeshes[0], kind, 25000);
}
TEST(ClosedPatches, NothingGetsThroughTheControlMeshOfACow) { examine_file(kMeshes[1], MeshKind::gregory, 50000); }

// Where patches fold beside a border, the chart and its spline turn their back at different places. In order: two crossings of one chart
// and one of its neighbour, nearer to each other than they were told apart by; a border that the spline leaves and the chart enters; a
// crossing 3e-4 of the chart beside a border where the spline has but one root for it and for the border; two roots of the spline beside
// which the line misses the chart.
TEST(ClosedPatches, LinesThroughFoldsBesideBordersEnterAsOftenAsTheyLeave) {
  Subject("lines through folds", read_polygons(data("meshes/spot-control-mesh.obj")), MeshKind::gregory, false)
      .examine_lines({{{-5.6857662973226519, 0.38875103515421777, -1.4423925334751577},
                       {0.97370707896264419, 0.075299947637250175, 0.21499870293530265}},
                      {{0.65216963721871957, -4.6502118455808867, -2.0177396841200936},
                       {-0.14296792663393834, 0.94729211929987645, 0.28670160911013626}},
                      {{-0.4822572802352369, 6.2534231680729864, 1.5864761175732098},
                       {0.099641362974127776, -0.94495760174074195, -0.31165161590635709}},
                      {{5.0013131125623014, 0.11626864148265026, -2.5879816039901771},
                       {-0.90642939818008805, 0.11165175209498604, 0.40733233651283213}}});
}

// Lines that 1e7 rays found. In order: two past a vertex by 1e-13 of the size, flatly, so that rounding alone decides on which side;
// through the border of two charts of one patch whose splines had different levels; through a border along which a patch folds, met on both
// sides.
TEST(ClosedPatches, LinesPastVerticesAndAlongFoldedBordersEnterAsOftenAsTheyLeave) {
  Subject("lines past vertices", read_polygons(data("meshes/spot-control-mesh.obj")), MeshKind::gregory, false)
      .examine_lines({{{-0.8301392789501546, -3.8321101426445878, 3.1986479461893476},
                       {0.16031134606110373, 0.78603439860675761, -0.59703450196030539}},
                      {{-4.7829803300893898, -2.1963397564339622, -0.67705018526102978},
                       {0.84725030771188703, 0.52484166836639612, 0.081903230879440028}},
                      {{-5.2185347064838092, 0.82249468012348992, 1.6320727974556914},
                       {0.94112356396371122, -0.0090817743011200654, -0.33794076215778662}},
                      {{-3.6626418441789719, 4.9189082974874552, -1.2193319145989594},
                       {0.65585987025237624, -0.73532661706222524, 0.17071202896210816}}});
}

// Rays that met nothing at their targets, which the reference (patch_intersector.h) meets. In order: on the border of two charts whose
// splines had different levels; two beside corners at which patches fold; a dip by less than the spline is away, 1e-8 of the size.
TEST(ClosedPatches, TargetsBesideFoldsAreMet) {
  Subject("targets beside folds", read_polygons(data("meshes/spot-control-mesh.obj")), MeshKind::gregory, false)
      .examine_targets({{{{-0.11667394458264001, 0.72986332278551402, -0.25479507007759472},
                          {0.42548738482189019, -0.034542151895504497, 0.90430488503593565}},
                         0.044575263430024381},
                        {{{0.16947173793350304, 0.79433463384835035, -0.3728102535419936},
                          {0.038157079724367292, 0.57704248093848953, 0.8158222922053926}},
                         0.0035479249021560162},
                        {{{-0.17052387097909122, 0.79602874021177539, -0.36769964400000965},
                          {0.11804176139566885, -0.86878531146675575, 0.4809139477559578}},
                         0.00024540147035962112},
                        {{{0.12804957323057098, 0.68703941715929762, -0.23068991973817576},
                          {0.79932091388972371, 0.46370436332834614, 0.38218364701900848}},
                         0.00010866991946320113}});
}

class ClosedPatchesSlow : public testing::TestWithParam<int> {};
TEST_P(ClosedPatchesSlow, NoneOfManyRaysGetsThrough) {
  examine_file(kMeshes[GetParam()], MeshKind::gregory, wanted("ISOPHOTE_RAYS", 200000));
}
const auto kNames = [](const testing::TestParamInfo<int>& info) { return std::string(kMeshes[info.param].name); };
INSTANTIATE_TEST_SUITE_P(All, ClosedPatchesSlow, testing::Values(0, 1, 2), kNames);

}  // namespace
}  // namespace iso::test
