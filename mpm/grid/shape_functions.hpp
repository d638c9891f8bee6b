// The shape functions, along one axis; a point's weights are products of two. For any kind of number: this text stands
// in the namespace that includes it, with doubles (shape.hpp) or lanes of them (transfer/lanes-inl.hpp, inside
// Highway's loop over instruction sets), which brings constant<T>(double) and, as Highway has them, MulAdd, NegMulAdd,
// Min, Max and Neg.
//
// Sources: bilinear: Sulsky, Chen & Schreyer 1994. uGIMP: Bardenhagen & Kober 2004 (CMES 5:477), points as squares that
// keep their size. Quadratic B-spline: Steffen, Kirby & Berzins 2008 (Int. J. Numer. Meth. Engng 76:922).
//
// Bilinear: the two nodes of the element, the coordinate xi in [0, 1] from the first. uGIMP and B-spline: the nearest
// node and its two neighbours, xi in [-1/2, 1/2] from the nearest.
//
// Walls. Where the nearest node lies on a wall along the grid, the node behind the wall is no unknown: its value is
// extrapolated linearly, v(-1) = 2 v(0) - v(1), that is, its weight goes to the other two. These boundary-modified
// functions are linear in the half cell next to the wall, still of one piece (C1) with the splines beyond, reproduce
// linear fields, stay positive, and the material at the wall moves with the wall's node. (Steffen et al.'s splines with
// a repeated knot serve the same end.) A wall between lines has its nearest row of nodes moved onto it: with the same
// lines, continued to the wall at s, v(s) = (1 - s) v(0) + s v(1) is the unknown in place of v(0), -1/2 < s <= 1/2
// (move_node()).

/// Weights of an axis' nodes, sum 1, and their derivatives per cell side, sum 0.
template <class T, int width>
struct Line {
  T w[width], g[width];
};

/// The node of a line moved by s towards `inner`, the next one; e = s/(1 - s).
template <class T, int width>
PIVNP_NUMBERS void move_node(Line<T, width>& line, int node, int inner, T e) {
  const T w = e * line.w[node], g = e * line.g[node];
  line.w[node] = line.w[node] + w;
  line.g[node] = line.g[node] + g;
  line.w[inner] = line.w[inner] - w;
  line.g[inner] = line.g[inner] - g;
}

struct BilinearShape {
  static constexpr int width = 2, first = 0;  // nodes an axis; the first one's place relative to xi's origin
  static constexpr bool centred = false, linear = true, needs_size = false;

  template <class T>
  PIVNP_NUMBERS static Line<T, 2> line(T xi, T) {
    return {{constant<T>(1) - xi, xi}, {constant<T>(-1), constant<T>(1)}};
  }
};

struct BSplineShape {
  static constexpr int width = 3, first = -1;
  static constexpr bool centred = true, linear = false, needs_size = false;

  template <class T>
  PIVNP_NUMBERS static Line<T, 3> line(T xi, T) {
    const T a = constant<T>(0.5) - xi, b = constant<T>(0.5) + xi;
    return {{constant<T>(0.5) * a * a, NegMulAdd(xi, xi, constant<T>(0.75)), constant<T>(0.5) * b * b},
            {Neg(a), constant<T>(-2) * xi, b}};
  }
  /// Beside a wall at the low or the high side, `s` inside its row of nodes.
  template <class T>
  PIVNP_NUMBERS static Line<T, 3> line_at_wall(T xi, T, bool low, T s) {
    const T zero = constant<T>(0), one = constant<T>(1);
    if (low) {
      xi = Max(xi, s);
      return {{zero, one - xi, xi}, {zero, constant<T>(-1), one}};
    }
    xi = Min(xi, Neg(s));
    return {{Neg(xi), one + xi, zero}, {constant<T>(-1), one, zero}};
  }
  /// Of APIC: one over the second moment of the weights about the point, sum w arm^2.
  template <class T>
  PIVNP_NUMBERS static T per_moment(const Line<T, 3>&, const T*) {
    return constant<T>(4);
  }
};

struct GimpShape {
  static constexpr int width = 3, first = -1;
  static constexpr bool centred = true, linear = false, needs_size = true;

  /// `half`: half the point's side over the cell's, at most 1/2.
  template <class T>
  PIVNP_NUMBERS static Line<T, 3> line(T xi, T half) {
    // A function's end, a parabola, and its side reach the nodes beside: by how far the point's square overlaps them. The
    // three make up one.
    const T per_size = constant<T>(0.5) / half, size = half + half;
    const auto beside = [&](T reach, T& w, T& g) PIVNP_NUMBERS_LAMBDA {
      reach = Max(constant<T>(0), reach);  // (of the two the second where it is not a number)
      const T end = Min(size, reach);
      g = end * per_size;
      w = MulAdd(constant<T>(0.5) * end, g, reach - end);
    };
    Line<T, 3> out;
    T fall;
    beside(half - xi, out.w[0], fall);
    beside(half + xi, out.w[2], out.g[2]);
    out.g[0] = Neg(fall);
    out.w[1] = (constant<T>(1) - out.w[0]) - out.w[2];
    out.g[1] = fall - out.g[2];
    return out;
  }
  /// The same as published, piece by piece.
  static Line<double, 3> line(double xi, double half) {
    Line<double, 3> out;
    for (int a = 0; a < 3; ++a) {
      const double x = xi - (a - 1), d = x < 0 ? -x : x, sign = x < 0 ? -1.0 : 1.0;
      if (d < half) {
        out.w[a] = 1 - (d * d + half * half) / (2 * half);
        out.g[a] = -x / half;
      } else if (d <= 1 - half) {
        out.w[a] = 1 - d;
        out.g[a] = -sign;
      } else if (d < 1 + half) {
        const double left = 1 + half - d;
        out.w[a] = left * left / (4 * half);
        out.g[a] = -sign * left / (2 * half);
      } else {
        out.w[a] = out.g[a] = 0;
      }
    }
    return out;
  }
  template <class T>
  PIVNP_NUMBERS static Line<T, 3> line_at_wall(T xi, T half, bool low, T s) {
    Line<T, 3> out = line(low ? Max(xi, s) : Min(xi, Neg(s)), half);
    const int behind = low ? 0 : 2, ahead = low ? 2 : 0;
    out.w[1] = MulAdd(constant<T>(2), out.w[behind], out.w[1]);
    out.g[1] = MulAdd(constant<T>(2), out.g[behind], out.g[1]);
    out.w[ahead] = out.w[ahead] - out.w[behind];
    out.g[ahead] = out.g[ahead] - out.g[behind];
    out.w[behind] = out.g[behind] = constant<T>(0);
    return out;
  }
  template <class T>
  PIVNP_NUMBERS static T per_moment(const Line<T, 3>& l, const T* arm) {
    return constant<T>(1) / (l.w[0] * arm[0] * arm[0] + l.w[1] * arm[1] * arm[1] + l.w[2] * arm[2] * arm[2]);
  }
};

struct Shapes {
  /// Calls `action` with an object of the shape's type: the one place where run time turns into compile time.
  template <class Action>
  PIVNP_NUMBERS static constexpr decltype(auto) with(ShapeKind kind, Action&& action) {
    switch (kind) {
      case ShapeKind::bilinear: return action(BilinearShape{});
      case ShapeKind::gimp: return action(GimpShape{});
      default: return action(BSplineShape{});
    }
  }
};
