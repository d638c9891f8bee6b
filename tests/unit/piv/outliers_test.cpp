// Outliers put into true fields, 5 to 20 % of the vectors, alone and in blocks: criterion 95 % found, 2 % false alarms.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/support/piv_outliers.hpp"

namespace pivnp::piv {
namespace {

TEST(Outliers, AreFoundAndGoodVectorsAreKept) {
  for (const OutlierKind kind : {OutlierKind::single, OutlierKind::cluster, OutlierKind::moved_cluster})
    for (const OutlierField& field : outlier_fields())
      for (const double share : outlier_shares) {
        const OutlierCounts c = inject(field, kind, share, {}, 11, 1);
        EXPECT_GE(c.outliers, share * 64 * 48);
        EXPECT_GE(c.found(), 0.95) << name(kind) << ", " << field.name << ", share " << share;
        EXPECT_LE(c.false_alarms(), 0.02) << name(kind) << ", " << field.name << ", share " << share;
      }
}

// Nothing is found where nothing was put in: the noise and the gradients of the fields are no outliers.
TEST(Outliers, FieldsWithoutThemPass) {
  for (const OutlierField& field : outlier_fields())
    EXPECT_LE(inject(field, OutlierKind::single, 0, {}, 3, 1).false_alarms(), 1e-3) << field.name;
}

}  // namespace
}  // namespace pivnp::piv
