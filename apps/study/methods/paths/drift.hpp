// What holds tracked particles to the frame they started from: direct correlation with it, or with a later key frame.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "apps/study/pipeline/scene/scene.hpp"
#include "pivnp/np/errors/bend_loss.hpp"
#include "pivnp/np/tracker.hpp"

namespace pivnp::app {

/// One round of direct correlation.
struct DriftRound {
  int frame = 0;
  std::size_t alive = 0;        // particles asked for
  std::size_t from_first = 0;   // held to the first frame
  std::size_t from_later = 0;   // to a later key frame
  double median_px = 0;         // of the distance the direct estimate lay from the prediction, over those held
};

/// np.drift of the case, on the tracker's own particles. Every particle is looked for where its own displacement and F
/// predict its subset (side: the PIV's window).
///   corrected         every np.drift_interval frames and at the last one. From the first frame where that succeeds,
///                     else from a later key frame; the estimate since the key frame is fused with the direct one by
///                     their covariances (np/errors/fusion.hpp). What fails is left as it was.
///   leapfrog          every frame, from the first one; the direct estimate replaces the summed one. Where it fails the
///                     particle goes on by the increment and is flagged.
///   reference_update  the same from a reference that moves to the frame before as soon as a tenth of the particles
///                     fails or correlates below .75 with it (Stanier, Blaber, Take & White 2016, who watch seed
///                     points).
/// A direct estimate counts if its correlation coefficient is at least .6, it lies near the prediction and in line with
/// its neighbours' (median test).
class DriftCorrector {
 public:
  DriftCorrector(const Case& c, const Setting& setting, int threads);
  ~DriftCorrector();

  /// Before the first step: `image` is the first frame, `tracker` at its start. `lost`: what bends have lost so far.
  void start(const np::Tracker& tracker, const np::BendLoss& lost, const ImageView& image);
  /// After the tracker's step to frame `frame`; `read` gives that frame where it is needed. `last`: there is none
  /// after. `alike_px`: the errors of paths at places d apart are correlated by exp(-d^2/(2 alike^2))
  /// (unseen_error.hpp).
  void after_step(np::Tracker& tracker, np::BendLoss& lost, int frame, bool last, double alike_px,
                  const std::function<Image()>& read);

  const std::vector<DriftRound>& rounds() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pivnp::app
