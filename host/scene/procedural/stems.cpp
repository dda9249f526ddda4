#include "scene/procedural/stems.hpp"

#include <algorithm>

namespace dapple {
namespace {

/// All stems as one line, by length.
class StemLine {
 public:
  explicit StemLine(const std::vector<Stem>& stems) : stems_(stems) {
    for (std::uint32_t s = 0; s < stems.size(); ++s) {
      for (std::uint32_t p = 0; p + 1 < stems[s].points.size(); ++p) {
        length_ += double{(stems[s].points[p + 1] - stems[s].points[p]).length()};
        pieces_.push_back({s, p, length_});
      }
    }
  }

  struct Place {
    V3f position, along, up;
  };

  /// `part` in [0, 1) of the whole length.
  [[nodiscard]] Place at(double part) const {
    const double where = part * length_;
    const auto piece =
        std::min(std::upper_bound(pieces_.begin(), pieces_.end(), where,
                                  [](double value, const Piece& p) { return value < p.end; }),
                 pieces_.end() - 1);
    const Stem& stem = stems_[piece->stem];
    const V3f a = stem.points[piece->point], b = stem.points[piece->point + 1];
    const double begin = piece == pieces_.begin() ? 0 : (piece - 1)->end;
    const auto t = static_cast<float>((where - begin) / (piece->end - begin));
    return {a + (b - a) * t, (b - a).normalized(), stem.up};
  }

 private:
  struct Piece {
    std::uint32_t stem, point;
    double end;
  };

  const std::vector<Stem>& stems_;
  std::vector<Piece> pieces_;
  double length_ = 0;
};

/// A unit vector at right angles to `along`, near `wanted` if that is not parallel.
V3f across(V3f along, V3f wanted) {
  const V3f rest = wanted - along * wanted.dot(along);
  return rest.length2() > 1e-6f ? rest.normalized() : perpendicular(along);
}

Blade blade_at(const StemLine::Place& place, const BladeHabit& habit, bool left, Pcg32& rng) {
  const V3f up = across(place.along, place.up), side = place.along.cross(up);
  const V2f turn = unit_circle(rng);
  const V3f wander = unit_vector(rng);
  const V3f sideways =
      habit.two_ranked ? side * (left ? 1.0f : -1.0f) : side * turn.x + up * turn.y;
  const V3f axis = sideways + place.along * habit.forward + wander * habit.wander;
  Blade blade;
  blade.base = place.position;
  blade.axis = (axis.normalized() + V3f(0, -habit.droop, 0)).normalized();
  blade.normal = across(blade.axis, habit.two_ranked ? up + wander * 0.3f : wander);
  blade.length = habit.length * rng.between(0.75f, 1.25f);
  blade.width = habit.width;
  return blade;
}

}  // namespace

Stem grow_stem(V3f foot, V3f direction, float length, int segments, V3f bend) {
  Stem stem;
  stem.points.push_back(foot);
  const float step = length / static_cast<float>(segments);
  for (int i = 0; i < segments; ++i) {
    stem.points.push_back(stem.points.back() + direction * step);
    direction = (direction + bend).normalized();
  }
  return stem;
}

void append_blades(Mesh& mesh, const std::vector<Stem>& stems, std::uint32_t count,
                   const BladeHabit& habit, std::uint32_t seed, std::uint32_t material) {
  const StemLine line(stems);
  BladeRange blades(mesh, count, material);
  for (std::uint32_t i = 0; i < count; ++i) {
    Pcg32 rng(seed, i);
    const double part = (static_cast<double>(i) + double{rng.unit()}) / count;
    blades.set(i, blade_at(line.at(part), habit, i % 2 == 0, rng));
  }
}

void append_stem_tubes(Mesh& mesh, const std::vector<Stem>& stems, float radius, int sides,
                       std::uint32_t material) {
  std::vector<float> radii;
  for (const Stem& stem : stems) {
    radii.clear();
    const auto count = static_cast<float>(stem.points.size());
    for (std::size_t i = 0; i < stem.points.size(); ++i)
      radii.push_back(radius * (1 - static_cast<float>(i) / count));
    append_tube(mesh, stem.points, radii, sides, material);
  }
}

}  // namespace dapple
