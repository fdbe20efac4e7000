#include "tess/join_edges.h"

#include <algorithm>
#include <tuple>

#include "tess/box_tree.h"
#include "tess/edge_match.h"

namespace iso {

namespace {

// From one round to the next the distance allowed grows by this factor.
constexpr double kWider = 10;

// Distances below this share of those allowed in a round count as equal, and orientation decides between partners.
constexpr double kAsNear = 0.01;

// Edges between the same two vertices are the same where they stray from each other by no more than this share of the part's size, and this
// of their own length, even if the file claims a smaller tolerance; as for shared edges (finish in patches/brep.h).
constexpr double kLyingGap = 1e-4, kLyingShare = 1e-3;

// Open borders are looked for within this share of the part's size.
constexpr double kLooked = 1e-3;

// Two pieces that became one edge.
struct Joined {
  EdgePiece first, second;
  EdgeMatch match;
};

struct Pair {
  std::size_t i, j;
  EdgeMatch match;
  bool against;  // the faces run the same way along the edge: one of them is turned
};

// What may be joined in a round: a free edge, or one of the pieces that vertices of others cut it into, which follow it.
struct Candidate {
  EdgePiece piece;
  std::size_t of = 0;  // index into free_
  bool is_whole = true;
  bool taken = false;
};

const EdgePiece& piece_of(const EdgePiece& piece) { return piece; }
const EdgePiece& piece_of(const Candidate& candidate) { return candidate.piece; }

template <class Pieces>
BoxTree<Vec3> tree_of_ends(const Pieces& pieces) {
  std::vector<Box3> boxes;
  for (const auto& of : pieces) {
    const EdgePiece& piece = piece_of(of);
    boxes.push_back({piece.at.front(), piece.at.front()});
    boxes.push_back({piece.at.back(), piece.at.back()});
  }
  return BoxTree<Vec3>(std::move(boxes));
}

// An order that does not depend on the order of faces and edges in the file.
bool lies_before(const EdgePiece& a, const EdgePiece& b) {
  for (const int place : {0, 1, 2})
    for (int axis = 0; axis < 3; ++axis) {
      const auto half = [&](const EdgePiece& p) { return p.at[(p.at.size() - 1) * static_cast<std::size_t>(place) / 2][axis]; };
      if (half(a) != half(b)) return half(a) < half(b);
    }
  return false;
}

class Joiner {
 public:
  Joiner(const Part& part, Boundary& boundary, double sew) : part_(part), boundary_(boundary) {
    for (const BoundaryEdge& edge : boundary.edges)
      if (edge.uses.size() == 1 && !edge.degenerate) free_.push_back(trace(part, boundary.uses, edge.uses[0], 0, 1));
    std::stable_sort(free_.begin(), free_.end(), lies_before);
    report_.free_edges = static_cast<int>(free_.size());
    report_.looked = kLooked * part.box.diagonal();
    report_.tolerance = join_tolerance(sew);
  }

  JoinReport run() {
    for (double allowed = kSameBorder * part_.box.diagonal();; allowed = std::min(report_.tolerance, allowed * kWider)) {
      join_within({allowed, allowed});
      if (!(allowed < report_.tolerance)) break;
    }
    join_within({report_.tolerance, std::max(report_.tolerance, kLyingGap * part_.box.diagonal())});
    rebuild();
    return finished();
  }

 private:
  double join_tolerance(double sew) const {
    const double size = part_.box.diagonal();
    double stated = 0;
    for (const EdgePiece& piece : free_)
      if (const int e = piece.use.curve.edge; e >= 0) stated = std::max(stated, part_.edges[static_cast<std::size_t>(e)].file_tolerance);
    return std::max({kSameBorder * size, std::min(stated, kMostStated * size), sew});
  }

  // Joins what lies within `allowed`. Splits that helped nobody are forgotten.
  void join_within(const MatchPolicy& allowed) {
    const auto cuts = find_cuts(allowed.ends);
    std::vector<Candidate> all;
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const EdgePiece& whole = free_[i];
      all.push_back({whole, i, true, false});
      for (std::size_t k = 0; !cuts[i].empty() && k <= cuts[i].size(); ++k) {
        const auto share = [&](double s) { return s == 1 ? whole.b : whole.a + s * (whole.b - whole.a); };
        const double a = k == 0 ? whole.a : share(cuts[i][k - 1]), b = k == cuts[i].size() ? whole.b : share(cuts[i][k]);
        all.push_back({trace(part_, boundary_.uses, whole.origin, a, b), i, false, false});
      }
    }
    join_pairs(all, allowed);
    keep_rest(all);
  }

  // Shares of each free piece at which the end of another one lies on it; pieces shorter than the whole tolerance are not made: ends that
  // should meet may be that far apart even where the curves agree far better.
  std::vector<std::vector<double>> find_cuts(double allowed) const {
    std::vector<std::vector<double>> cuts(free_.size());
    const BoxTree<Vec3> ends = tree_of_ends(free_);
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const EdgePiece& piece = free_[i];
      ends.for_each_touching(piece.box.inflated(allowed), [&](std::uint32_t e) {
        const Point3& end = ends.box(e).lo;
        if (e / 2 == i || !may_join(piece, free_[e / 2]) || near_end(piece, end)) return;
        const NearPlace near = nearest_place(piece, end, allowed);
        if (near.distance <= allowed && !near_end(piece, place(piece, near.share))) cuts[i].push_back(near.share);
      });
      thin_out(piece, cuts[i]);
    }
    return cuts;
  }

  bool may_join(const EdgePiece& a, const EdgePiece& b) const { return a.face->solid == b.face->solid; }

  bool near_end(const EdgePiece& piece, const Point3& p) const {
    return glm::length(p - piece.at.front()) <= report_.tolerance || glm::length(p - piece.at.back()) <= report_.tolerance;
  }

  static Point3 place(const EdgePiece& piece, double share) { return point(piece.face->surface, uv_at(piece.use, share)); }

  // Of cuts within the tolerance of each other, the first.
  void thin_out(const EdgePiece& piece, std::vector<double>& cuts) const {
    std::sort(cuts.begin(), cuts.end());
    std::vector<double> kept;
    for (double s : cuts)
      if (kept.empty() || glm::length(place(piece, s) - place(piece, kept.back())) > report_.tolerance) kept.push_back(s);
    cuts = std::move(kept);
  }

  void join_pairs(std::vector<Candidate>& all, const MatchPolicy& allowed) {
    std::vector<Pair> pairs = find_pairs(all, allowed);
    const auto key = [&](const Pair& p) {
      const int cut = !all[p.i].is_whole + !all[p.j].is_whole;
      return std::make_tuple(std::max(p.match.apart, kAsNear * allowed.between), p.against, cut, p.i, p.j);
    };
    std::sort(pairs.begin(), pairs.end(), [&](const Pair& a, const Pair& b) { return key(a) < key(b); });
    // An edge is taken whole or in pieces.
    std::vector<char> whole_taken(free_.size(), 0), part_taken(free_.size(), 0);
    const auto is_taken = [&](const Candidate& c) { return c.taken || whole_taken[c.of] || (c.is_whole && part_taken[c.of]); };
    for (Pair& pair : pairs) {
      if (is_taken(all[pair.i]) || is_taken(all[pair.j])) continue;
      for (const std::size_t k : {pair.i, pair.j}) {
        all[k].taken = true;
        (all[k].is_whole ? whole_taken : part_taken)[all[k].of] = 1;
      }
      report_.widest = std::max(report_.widest, pair.match.apart);
      joined_.push_back({all[pair.i].piece, all[pair.j].piece, std::move(pair.match)});
    }
  }

  std::vector<Pair> find_pairs(const std::vector<Candidate>& all, const MatchPolicy& allowed) const {
    std::vector<Pair> pairs;
    const BoxTree<Vec3> ends = tree_of_ends(all);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const EdgePiece& piece = all[i].piece;
      std::vector<std::size_t> near;
      ends.for_each_touching(Box3{piece.at.front(), piece.at.front()}.inflated(2 * allowed.ends),
                             [&](std::uint32_t e) { near.push_back(e / 2); });
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      for (std::size_t j : near) {
        const EdgePiece& other = all[j].piece;
        if (j <= i || !may_join(piece, other) || (all[i].of == all[j].of && all[i].is_whole)) continue;
        auto found = match(piece, other, allowed);
        if (!found || (found->apart > 2 * allowed.ends && found->apart > kLyingShare * piece.length())) continue;
        const auto runs = [](const EdgePiece& p) { return p.use.forward != p.face->reversed; };
        const bool against = runs(piece) == (runs(other) != found->reversed);
        pairs.push_back({i, j, std::move(*found), against});
      }
    }
    return pairs;
  }

  // What is left free: edges of which no piece was joined are whole, and neighbours of the others are one.
  void keep_rest(const std::vector<Candidate>& all) {
    std::vector<EdgePiece> rest;
    for (std::size_t i = 0; i < all.size();) {
      const EdgePiece& whole = all[i].piece;
      std::size_t end = i + 1, taken = all[i].taken;
      for (; end < all.size() && all[end].of == all[i].of; ++end) taken += all[end].taken;
      if (taken == 0) rest.push_back(whole);
      for (std::size_t k = i + 1; taken > 0 && !all[i].taken && k < end; ++k) {
        if (all[k].taken) continue;
        const std::size_t first = k;
        while (k + 1 < end && !all[k + 1].taken) ++k;
        rest.push_back(first == k ? all[k].piece : trace(part_, boundary_.uses, whole.origin, all[first].piece.a, all[k].piece.b));
      }
      i = end;
    }
    free_ = std::move(rest);
  }

  // ---- the boundary anew ----

  struct Fate {
    const EdgePiece* piece;
    int joined;  // index into joined_, -1: none
  };

  std::vector<std::vector<Fate>> fates() const {
    std::vector<std::vector<Fate>> of_use(boundary_.uses.size());
    for (const EdgePiece& piece : free_) of_use[static_cast<std::size_t>(piece.origin)].push_back({&piece, -1});
    for (std::size_t k = 0; k < joined_.size(); ++k)
      for (const EdgePiece* piece : {&joined_[k].first, &joined_[k].second})
        of_use[static_cast<std::size_t>(piece->origin)].push_back({piece, static_cast<int>(k)});
    for (auto& of : of_use) std::sort(of.begin(), of.end(), [](const Fate& a, const Fate& b) { return a.piece->a < b.piece->a; });
    return of_use;
  }

  void rebuild() {
    const auto of_use = fates();
    edge_of_open_.assign(free_.size(), -1);
    std::vector<BoundaryEdge> edges;
    std::vector<std::vector<int>> pieces_of(boundary_.uses.size());  // uses that take the place of one
    std::vector<int> edge_of_joined(joined_.size(), -1);
    for (const BoundaryEdge& edge : std::vector<BoundaryEdge>(boundary_.edges)) {
      const auto first = static_cast<std::size_t>(edge.uses[0]);
      if (of_use[first].empty()) {
        for (int use : edge.uses) boundary_.uses[static_cast<std::size_t>(use)].edge = static_cast<int>(edges.size());
        edges.push_back(edge);
        continue;
      }
      report_.split += static_cast<int>(of_use[first].size()) - 1;
      for (std::size_t k = 0; k < of_use[first].size(); ++k) {
        const int use = k == 0 ? static_cast<int>(first) : static_cast<int>(boundary_.uses.size());
        if (k > 0) boundary_.uses.emplace_back();
        pieces_of[first].push_back(use);
        place_use(of_use[first][k], use, edge.part_edge, edges, edge_of_joined);
      }
    }
    boundary_.edges = std::move(edges);
    for (auto& of_face : boundary_.loops)
      for (auto& loop : of_face) replace(loop, pieces_of);
  }

  // Makes a piece the use of that number, on an edge of its own or on its partner's; the first of the two is the edge's first use.
  void place_use(const Fate& fate, int use, int part_edge, std::vector<BoundaryEdge>& edges, std::vector<int>& edge_of_joined) {
    EdgeUse placed = fate.piece->use;
    const Joined* pair = fate.joined < 0 ? nullptr : &joined_[static_cast<std::size_t>(fate.joined)];
    int own = -1;
    int& edge = pair ? edge_of_joined[static_cast<std::size_t>(fate.joined)] : own;
    if (edge < 0) {
      edge = static_cast<int>(edges.size());
      edges.push_back({{}, {}, part_edge, false});
    }
    if (!pair) edge_of_open_[static_cast<std::size_t>(fate.piece - free_.data())] = edge;
    const bool is_second = pair && fate.piece == &pair->second;
    if (is_second) follow(pair->match, placed);
    placed.edge = edge;
    auto& uses = edges[static_cast<std::size_t>(edge)].uses;
    uses.insert(is_second ? uses.end() : uses.begin(), use);
    boundary_.uses[static_cast<std::size_t>(use)] = std::move(placed);
  }

  // Gives the second use the direction of the first, and the shares at which they meet.
  static void follow(const EdgeMatch& match, EdgeUse& use) {
    if (match.reversed) use.forward = !use.forward;
    use.shares_parameter = match.even;
    if (!match.even) use.matched = match.shares;
  }

  void replace(std::vector<int>& loop, const std::vector<std::vector<int>>& pieces_of) const {
    std::vector<int> result;
    for (int use : loop) {
      const auto& pieces = pieces_of[static_cast<std::size_t>(use)];
      const TrimCurve& curve = boundary_.uses[static_cast<std::size_t>(use)].curve;
      if (pieces.empty())
        result.push_back(use);
      else if (curve.t0 <= curve.t1)
        result.insert(result.end(), pieces.begin(), pieces.end());
      else
        result.insert(result.end(), pieces.rbegin(), pieces.rend());
    }
    loop = std::move(result);
  }

  // ---- report ----

  JoinReport finished() {
    report_.joined = static_cast<int>(joined_.size());
    std::vector<Box3> boxes;
    for (const EdgePiece& piece : free_) boxes.push_back(piece.box);
    const BoxTree<Vec3> tree(std::move(boxes));
    for (std::size_t i = 0; i < free_.size(); ++i) report_.open.push_back(open_border(i, tree));
    std::stable_sort(report_.open.begin(), report_.open.end(),
                     [](const OpenBorder& a, const OpenBorder& b) { return std::tie(a.face, a.edge) < std::tie(b.face, b.edge); });
    return std::move(report_);
  }

  OpenBorder open_border(std::size_t i, const BoxTree<Vec3>& tree) const {
    const EdgePiece& piece = free_[i];
    const std::size_t kept = (piece.at.size() - 1) / 8;  // of so many places one is looked at
    double width = 0;
    for (std::size_t k = 0; k < piece.at.size() && width <= report_.looked; k += kept) {
      double nearest = kInf;
      const Point3& p = piece.at[k];
      tree.for_each_touching(Box3{p, p}.inflated(report_.looked), [&](std::uint32_t j) {
        if (j != i) nearest = std::min(nearest, nearest_place(free_[j], p, report_.looked).distance);
      });
      width = std::max(width, nearest <= report_.looked ? nearest : kInf);
    }
    return {piece.use.face, piece.use.curve.edge, edge_of_open_[i], piece.at.front(), piece.at.back(), piece.length(), width};
  }

  const Part& part_;
  Boundary& boundary_;
  std::vector<EdgePiece> free_;
  std::vector<Joined> joined_;
  std::vector<int> edge_of_open_;  // of each free piece, in the new boundary
  JoinReport report_;
};

}  // namespace

JoinReport join_edges(const Part& part, Boundary& boundary, double sew) {
  if (sew < 0) return {};
  const auto is_free = [](const BoundaryEdge& edge) { return edge.uses.size() == 1 && !edge.degenerate; };
  if (std::none_of(boundary.edges.begin(), boundary.edges.end(), is_free)) return {};
  return Joiner(part, boundary, sew).run();
}

}  // namespace iso
