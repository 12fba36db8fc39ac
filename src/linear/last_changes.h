#pragma once

#include <string>
#include <vector>

#include "base/archive.h"
#include "base/change_marks.h"
#include "base/ordered_loops.h"
#include "linear/operator.h"
#include "linear/short_rows.h"

namespace argil::linear {

/// What the last three solves added to their x. Systems of successive steps have like solutions: the next
/// solve begins with the combination of these that is nearest to its own [Fischer1998]. Where that proves of
/// little use, none does for a while, which is the longer the more often that happens.
class LastChanges {
 public:
  static constexpr int kKept = 3;

  /// Takes the memory for so many rows; what is kept stays as it is.
  void prepare(std::ptrdiff_t num_rows);

  /// What a solve of A x = r goes on from.
  struct Start {
    double energy = 0.0;  ///< eᵀA e of the error e, by how much it is less
    int products = 0;     ///< with the matrix; iterations count them
  };
  /// x = Σ aₖ dₖ with the aₖ that take most of the error's energy away, r −= A x; nothing while it rests.
  Start begin(const ShortRows& matrix, Operator& whole, const OrderedRuns& runs, std::ptrdiff_t num_rows,
              float* x, float* r);
  /// What begin took away of the energy and what the solve took in all.
  void judge(const Start& start, double energy);
  /// What a solve added to its x: `scale` times `x`.
  void keep(const OrderedRuns& runs, std::ptrdiff_t num_rows, const float* x, double scale);
  /// Forgets rows begin … end−1.
  void clear(std::ptrdiff_t begin, std::ptrdiff_t end);
  void serialize(Archive& archive, const std::string& prefix);

  /// Solves since the last commit count from now on; or they never were.
  void commit();
  void roll_back();

  /// Of changes and what they are multiplied to with one another, i ≥ k, and of changes with r.
  struct Products {
    double dy[kKept][kKept] = {};  ///< [k][i]: dᵢ·A dₖ
    double dr[kKept] = {};
  };

 private:
  // The last change d₀, how much more that was than the one before, d₁, and how much more d₁ grew, d₂: alike
  // changes have small differences, which stay apart where the changes themselves would not. Four a row, in
  // units of m_use.scale.
  std::vector<float> m_d[kKept];
  std::vector<float> m_product[kKept];  // A dₖ
  std::vector<Products> m_products;     // of each run
  struct Use {
    double scale = 0.0;
    int rest = 0;       // solves to come that do without
    int next_rest = 1;  // after the next one that they were of little use to
  };
  void remember(std::ptrdiff_t begin, std::ptrdiff_t end);

  Use m_use, m_committed_use;
  std::vector<float> m_committed_d[kKept];  // of runs that have changed since the last commit
  ChangeMarks m_changed_runs;
};

}  // namespace argil::linear
