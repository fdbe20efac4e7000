#include "tess/boundary.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "tess/inner_poles.h"

namespace iso {

double parameter_at(const EdgeUse& use, double share) {
  const double a = use.forward ? use.curve.t0 : use.curve.t1, b = use.forward ? use.curve.t1 : use.curve.t0;
  return share == 1 ? b : a + share * (b - a);
}

UV uv_at(const EdgeUse& use, double share) { return jet(use.curve.curve, parameter_at(use, share)).C; }

EdgeUse part_of(const EdgeUse& use, double a, double b) {
  EdgeUse part = use;
  const double from = parameter_at(use, a), to = parameter_at(use, b);
  part.curve.t0 = use.forward ? from : to;
  part.curve.t1 = use.forward ? to : from;
  return part;
}

namespace {

Point3 place(const Part& part, const EdgeUse& use, double share) {
  return point(part.faces[static_cast<std::size_t>(use.face)].surface, uv_at(use, share));
}

// Sets of numbers that grow together.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }
  int root(int a) {
    while (parent_[static_cast<std::size_t>(a)] != a)
      a = parent_[static_cast<std::size_t>(a)] = parent_[static_cast<std::size_t>(parent_[static_cast<std::size_t>(a)])];
    return a;
  }
  void join(int a, int b) {
    a = root(a), b = root(b);
    parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }

 private:
  std::vector<int> parent_;
};

TrimCurve side(const UV& from, const UV& to) {
  TrimCurve curve;
  curve.curve = Line<Vec2>{from, to - from};
  return curve;
}

// Distances of this share of the size are rounding.
constexpr double kPoint = 1e-12;

// Places at which two uses are compared.
constexpr int kMatches = 16;

// How far a use gets from its first end.
double extent_of(const Part& part, const EdgeUse& use) {
  double extent = 0;
  for (int i = 1; i <= kMatches; ++i)
    extent = std::max(extent, glm::length(place(part, use, static_cast<double>(i) / kMatches) - place(part, use, 0)));
  return extent;
}

// The largest distance between two uses at equal shares.
double apart(const Part& part, const EdgeUse& a, const EdgeUse& b) {
  double worst = 0;
  for (int i = 0; i <= kMatches; ++i) {
    const double s = static_cast<double>(i) / kMatches;
    worst = std::max(worst, glm::length(place(part, a, s) - place(part, b, s)));
  }
  return worst;
}

// Gives a use the direction of the edge's first use, by native parameters if they agree, else by where it lies.
void direct(const Part& part, const EdgeUse& first, EdgeUse& use, double gap) {
  use.forward = (use.curve.t0 < use.curve.t1) == (first.curve.t0 < first.curve.t1) ? first.forward : !first.forward;
  const double same = apart(part, first, use);
  if (same <= gap) return;
  use.forward = !use.forward;
  const double turned = apart(part, first, use);
  if (turned > same) use.forward = !use.forward;
  use.shares_parameter = std::min(same, turned) <= gap;
}

// The four sides of a domain, counter-clockwise; opposite sides that coincide in space become one edge, collapsed ones are degenerate.
void add_sides(const Part& part, int face_index, Boundary& boundary) {
  const Face& face = part.faces[static_cast<std::size_t>(face_index)];
  const Box2& d = face.domain;
  const std::array<UV, 4> corner{d.lo, UV(d.hi.x, d.lo.y), d.hi, UV(d.lo.x, d.hi.y)};
  std::vector<int> loop;
  std::array<EdgeUse, 4> uses;
  const double tiny = kPoint * bounds(face.surface, d).diagonal();
  for (int k = 0; k < 4; ++k) {
    const std::size_t i = static_cast<std::size_t>(k);
    uses[i].face = face_index;
    uses[i].curve = side(corner[i], corner[(i + 1) % 4]);
    uses[i].edge = -1;
    if (k >= 2) {
      EdgeUse turned = uses[i];
      turned.forward = false;
      if (apart(part, uses[i - 2], turned) <= tiny) {
        uses[i].forward = false;
        uses[i].edge = uses[i - 2].edge;
      }
    }
    if (uses[i].edge < 0) {
      uses[i].edge = static_cast<int>(boundary.edges.size());
      boundary.edges.push_back({{}, {}, -1, extent_of(part, uses[i]) <= tiny});
    }
    loop.push_back(static_cast<int>(boundary.uses.size()));
    boundary.edges[static_cast<std::size_t>(uses[i].edge)].uses.push_back(loop.back());
    boundary.uses.push_back(uses[i]);
  }
  boundary.loops.back().push_back(std::move(loop));
}

// Edges of no length are points, whether the file says so or not.
void mark_points(const Part& part, Boundary& boundary) {
  const double tiny = kPoint * part.box.diagonal();
  for (BoundaryEdge& edge : boundary.edges)
    edge.degenerate = edge.degenerate || std::all_of(edge.uses.begin(), edge.uses.end(), [&](int use) {
                        return extent_of(part, boundary.uses[static_cast<std::size_t>(use)]) <= tiny;
                      });
}

// Loops of a face that touch in a point of (u, v) have one vertex there: the face's triangles have one node.
void join_touching_loops(const Part& part, const Boundary& boundary, Sets& ends) {
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    std::vector<std::pair<UV, int>> starts;
    for (const auto& loop : boundary.loops[f])
      for (const int u : loop) {
        const EdgeUse& use = boundary.uses[static_cast<std::size_t>(u)];
        starts.push_back({uv_at(use, use.forward ? 0 : 1), 2 * use.edge + (use.forward ? 0 : 1)});
      }
    std::sort(starts.begin(), starts.end(), [](const auto& a, const auto& b) { return a.first.x < b.first.x; });
    const Vec2 tiny = kPoint * part.faces[f].domain.size();
    for (std::size_t i = 0; i < starts.size(); ++i)
      for (std::size_t j = i + 1; j < starts.size() && starts[j].first.x - starts[i].first.x <= tiny.x; ++j)
        if (std::abs(starts[j].first.y - starts[i].first.y) <= tiny.y) ends.join(starts[i].second, starts[j].second);
  }
}

// Where a use ends the next of its loop begins: one vertex.
void number_vertices(const Part& part, Boundary& boundary) {
  Sets ends(2 * boundary.edges.size());
  join_touching_loops(part, boundary, ends);
  for (const auto& of_face : boundary.loops)
    for (const auto& loop : of_face)
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const EdgeUse& a = boundary.uses[static_cast<std::size_t>(loop[i])];
        const EdgeUse& b = boundary.uses[static_cast<std::size_t>(loop[(i + 1) % loop.size()])];
        ends.join(2 * a.edge + (a.forward ? 1 : 0), 2 * b.edge + (b.forward ? 0 : 1));
      }
  for (std::size_t e = 0; e < boundary.edges.size(); ++e)
    if (boundary.edges[e].degenerate) ends.join(static_cast<int>(2 * e), static_cast<int>(2 * e + 1));
  std::vector<int> number(2 * boundary.edges.size(), -1);
  for (std::size_t e = 0; e < boundary.edges.size(); ++e)
    for (int k = 0; k < 2; ++k) {
      int& n = number[static_cast<std::size_t>(ends.root(static_cast<int>(2 * e) + k))];
      if (n < 0) n = boundary.vertex_count++;
      boundary.edges[e].vertex[static_cast<std::size_t>(k)] = n;
    }
}

// Up to this many tolerances edges are short: each end may have moved by two.
constexpr double kShort = 4;

// A gap of this share of the part's size at a vertex is closed, whatever the tolerance.
constexpr double kLargestGap = 1e-4;

// Where all ends of a vertex lie, and how far from their middle.
struct VertexSpread {
  Point3 middle{0.0};
  double most = 0;
  int ends = 0;
};

std::vector<VertexSpread> vertex_spreads(const Part& part, const Boundary& boundary) {
  std::vector<VertexSpread> all(static_cast<std::size_t>(boundary.vertex_count));
  const auto for_ends = [&](auto f) {
    for (const EdgeUse& use : boundary.uses)
      for (const std::size_t k : {0, 1})
        f(all[static_cast<std::size_t>(boundary.edges[static_cast<std::size_t>(use.edge)].vertex[k])],
          place(part, use, static_cast<double>(k)));
  };
  for_ends([](VertexSpread& v, const Point3& p) { v.middle += p, ++v.ends; });
  for (VertexSpread& v : all) v.middle /= std::max(1, v.ends);
  for_ends([](VertexSpread& v, const Point3& p) { v.most = std::max(v.most, glm::length(p - v.middle)); });
  return all;
}

// A free edge that is shorter than the way its vertices moved becomes a point: else it would be drawn out, and turn about.
void join_ends_of_dwarfed_edges(const Part& part, Boundary& boundary) {
  const std::vector<VertexSpread> spreads = vertex_spreads(part, boundary);
  Sets vertices(spreads.size());
  for (BoundaryEdge& edge : boundary.edges) {
    if (edge.degenerate || edge.uses.size() != 1 || edge.vertex[0] == edge.vertex[1]) continue;
    const EdgeUse& use = boundary.uses[static_cast<std::size_t>(edge.uses[0])];
    const double moved = spreads[static_cast<std::size_t>(edge.vertex[0])].most + spreads[static_cast<std::size_t>(edge.vertex[1])].most;
    if (moved > 0 && extent_of(part, use) <= moved) vertices.join(edge.vertex[0], edge.vertex[1]);
  }
  for (BoundaryEdge& edge : boundary.edges)
    for (int& v : edge.vertex) v = vertices.root(v);
}

// Short edges whose ends are one vertex but do not lie together are points: gaps that a face closes with an edge of its own, or edges whose
// neighbours were joined with edges that meet in one.
void collapse_short_edges(const Part& part, Boundary& boundary) {
  for (BoundaryEdge& edge : boundary.edges) {
    if (edge.degenerate || edge.vertex[0] != edge.vertex[1]) continue;
    const EdgeUse& use = boundary.uses[static_cast<std::size_t>(edge.uses[0])];
    const double apart = glm::length(place(part, use, 1) - place(part, use, 0)), extent = extent_of(part, use);
    // Edges that were closed before enclose something.
    if (extent > std::max(kShort * boundary.joins.tolerance, kLargestGap * part.box.diagonal()) || apart < 0.5 * extent) continue;
    edge.degenerate = true;
    ++boundary.joins.collapsed;
  }
}

// Short free edges between the same two vertices are one, for the same reason.
void join_short_edges(const Part& part, Boundary& boundary) {
  std::map<std::pair<int, int>, int> seen;
  for (std::size_t e = 0; e < boundary.edges.size(); ++e) {
    BoundaryEdge& edge = boundary.edges[e];
    if (edge.degenerate || edge.uses.size() != 1 || edge.vertex[0] == edge.vertex[1]) continue;
    EdgeUse& use = boundary.uses[static_cast<std::size_t>(edge.uses[0])];
    if (extent_of(part, use) > kShort * boundary.joins.tolerance) continue;
    const auto [known, is_new] = seen.try_emplace(std::minmax(edge.vertex[0], edge.vertex[1]), static_cast<int>(e));
    if (is_new) continue;
    BoundaryEdge& first = boundary.edges[static_cast<std::size_t>(known->second)];
    if (first.vertex[0] != edge.vertex[0]) use.forward = !use.forward;
    use.edge = known->second;
    first.uses.push_back(edge.uses[0]);
    edge.uses.clear();
    seen.erase(known);
    ++boundary.joins.joined;
  }
}

// Leaves out edges without uses, and reports as open what still is.
void compact(Boundary& boundary) {
  std::vector<int> number(boundary.edges.size(), -1);
  std::vector<BoundaryEdge> kept;
  for (std::size_t e = 0; e < boundary.edges.size(); ++e) {
    if (boundary.edges[e].uses.empty()) continue;
    number[e] = static_cast<int>(kept.size());
    kept.push_back(std::move(boundary.edges[e]));
  }
  for (EdgeUse& use : boundary.uses) use.edge = number[static_cast<std::size_t>(use.edge)];
  boundary.edges = std::move(kept);
  auto& open = boundary.joins.open;
  for (OpenBorder& border : open) border.edge = number[static_cast<std::size_t>(border.edge)];
  std::erase_if(open, [&](const OpenBorder& border) {
    if (border.edge < 0) return true;
    const BoundaryEdge& edge = boundary.edges[static_cast<std::size_t>(border.edge)];
    return edge.degenerate || edge.uses.size() > 1;
  });
}

}  // namespace

Boundary::Boundary(const Part& part, double sew) {
  std::vector<int> of_part_edge(part.edges.size(), -1);
  for (std::size_t f = 0; f < part.faces.size(); ++f) {
    const Face& face = part.faces[f];
    loops.emplace_back();
    if (face.loops.empty()) add_sides(part, static_cast<int>(f), *this);
    for (const TrimLoop& loop : face.loops) {
      std::vector<int> indices;
      for (const TrimCurve& curve : loop.curves) {
        EdgeUse use{static_cast<int>(f), -1, curve, curve.t0 <= curve.t1, true};
        int* known = curve.edge >= 0 ? &of_part_edge[static_cast<std::size_t>(curve.edge)] : nullptr;
        if (known && *known >= 0) {
          use.edge = *known;
        } else {
          use.edge = static_cast<int>(edges.size());
          edges.push_back({{}, {}, curve.edge, known && part.edges[static_cast<std::size_t>(curve.edge)].degenerate});
          if (known) *known = use.edge;
        }
        BoundaryEdge& edge = edges[static_cast<std::size_t>(use.edge)];
        if (!edge.uses.empty()) {
          const Edge& in_part = part.edges[static_cast<std::size_t>(curve.edge)];
          direct(part, uses[static_cast<std::size_t>(edge.uses[0])], use,
                 std::max(1.5 * std::max(in_part.gap, in_part.file_tolerance), 1e-9 * part.box.diagonal()));
        }
        indices.push_back(static_cast<int>(uses.size()));
        edge.uses.push_back(indices.back());
        uses.push_back(std::move(use));
      }
      loops.back().push_back(std::move(indices));
    }
  }
  mark_points(part, *this);
  add_inner_poles(part, *this);
  joins = join_edges(part, *this, sew);
  number_vertices(part, *this);
  collapse_short_edges(part, *this);
  if (joins.joined > 0) {
    join_short_edges(part, *this);
    join_ends_of_dwarfed_edges(part, *this);
    collapse_short_edges(part, *this);
  }
  compact(*this);
}

// Newton steps along the curve, clamped to [lo, hi]; a step that leads uphill is halved. Where the curve lies still, all places are equally
// near: a place is left only for one that is nearer by more than rounding.
double slide_share(const Face& face, const EdgeUse& use, const Point3& p, double from, double lo, double hi) {
  constexpr int kSteps = 24;
  constexpr double kRounding = 64 * kEps;  // of places, as a share of the coordinates
  const double a = parameter_at(use, 0), b = parameter_at(use, 1), rounding = kRounding * glm::length(p);
  double best = from, least = kInf;
  for (int i = 0; i < kSteps; ++i) {
    const auto curve = jet(use.curve.curve, parameter_at(use, from));
    const Jet2 at = jet2(face.surface, curve.C);
    const Vec3 r = p - at.S, tangent = (at.Su * curve.Ct.x + at.Sv * curve.Ct.y) * (b - a);
    const double d = glm::length(r), along = glm::dot(r, tangent), speed2 = glm::dot(tangent, tangent);
    double next = 0.5 * (from + best);
    if (d < least) {
      best = from;
      least = d;
      if (!(std::abs(along) > rounding * std::sqrt(speed2))) break;
      next = std::clamp(from + along / speed2, lo, hi);
    } else if (!(d - least > rounding)) {
      break;
    }
    if (std::abs(next - from) < 4 * kEps) break;
    from = next;
  }
  return best;
}

namespace {

// The curve of one use may run ahead of or behind that of another by this share of the edge.
constexpr double kWithin = 0.25;

double nearest_share(const Face& face, const EdgeUse& use, const Point3& p, double near) {
  const double lo = std::max(0.0, near - kWithin), hi = std::min(1.0, near + kWithin);
  constexpr int kSteps = 8;
  double best = near, least = kInf;
  for (int i = 0; i <= kSteps; ++i) {
    const double s = lo + (hi - lo) * i / kSteps, d = glm::length(point(face.surface, uv_at(use, s)) - p);
    if (d < least) best = s, least = d;
  }
  return slide_share(face, use, p, best, lo, hi);
}

}  // namespace

double own_share(const Face& face, const EdgeUse& use, const Point3& p, double share) {
  if (share <= 0 || share >= 1) return share;
  if (use.matched.empty()) return nearest_share(face, use, p, share);
  const double steps = static_cast<double>(use.matched.size() - 1), at = share * steps;
  const auto k = std::min(static_cast<std::size_t>(at), use.matched.size() - 2);
  const double lo = use.matched[k], hi = use.matched[k + 1];
  return slide_share(face, use, p, lo + (at - static_cast<double>(k)) * (hi - lo), lo, hi);
}

double first_share(const Face& face, const EdgeUse& first, const EdgeUse& use, const Point3& p, double own) {
  if (own <= 0 || own >= 1) return own;
  if (use.matched.empty()) return nearest_share(face, first, p, own);
  const auto above = std::upper_bound(use.matched.begin() + 1, use.matched.end() - 1, own);
  const double steps = static_cast<double>(use.matched.size() - 1), k = static_cast<double>(above - use.matched.begin() - 1);
  const double from = *(above - 1), part = (own - from) / (*above - from);
  return slide_share(face, first, p, (k + part) / steps, k / steps, (k + 1) / steps);
}

}  // namespace iso
