// The chains of several engines that the commands run, as a library of values: no argv, no printing.
#pragma once

#include "apps/study/element/element.hpp"
#include "apps/study/frontier/frontier.hpp"
#include "apps/study/stress/stress.hpp"
#include "apps/study/studies/calibrate.hpp"
#include "apps/study/studies/check.hpp"
#include "apps/study/studies/query.hpp"
#include "apps/study/studies/records.hpp"
#include "apps/study/studies/run.hpp"
#include "apps/study/studies/verify.hpp"
#include "apps/study/sweep/sweep.hpp"
#include "apps/study/synth/synthesize.hpp"
