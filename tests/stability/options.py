#!/usr/bin/python3
"""Every key and every choice of the option lists in a small valid case of its own, run to its report.

usage: options.py PIVNP CASE_REFERENCE [EACH]

CASE_REFERENCE is docs/case.md, which is generated from the option lists (a test of its own holds it to them). A key whose
value follows neither from its type and range nor from VALUES below fails the test: whoever adds one says here what a
valid case with it looks like. EACH: only every so many of the cases, evenly.
"""
import concurrent.futures
import copy
import pathlib
import random
import re
import struct
import sys

from program import folder, run

SAND = {"model": '"mohr_coulomb"', "density_kg_m3": "1500.0", "young_pa": "1e6", "friction_deg": "35.0", "cohesion_pa": "1000.0"}
SIMULATION = {
    "grid": {"spacing_m": "0.02", "area_m": "[[0.0, 0.0], [0.12, 0.16]]"},
    "region.soil": {"polygon_m": "[[0.0, 0.0], [0.08, 0.0], [0.08, 0.08], [0.0, 0.08]]"},
    "material.soil": {"model": '"linear_elastic"', "density_kg_m3": "1500.0", "young_pa": "1e6"},
    "mpm": {"end_s": "0.02", "output_rate_hz": "100.0"},
    "boundary.base": {"line_m": "[[0.0, 0.0], [0.12, 0.0]]"},
}
TWO_BODIES = SIMULATION | {
    "region.soil": {"polygon_m": "[[0.0, 0.0], [0.08, 0.0], [0.08, 0.04], [0.0, 0.04]]"},
    "region.above": {"polygon_m": "[[0.0, 0.04], [0.08, 0.04], [0.08, 0.08], [0.0, 0.08]]", "material": '"soil"'},
}
MEASUREMENT = {
    "frames": {"rate_hz": "100.0"},
    "camera": {"metres_per_pixel": "0.001"},
    "grid": {"spacing_px": "8"},
    "region.soil": {"polygon_px": "[[15, 79], [79, 79], [79, 31], [15, 31]]"},
    "piv": {"window_px": "16"},
    "np": {},
    "synth": {"motion": '"affine"', "width_px": "96", "height_px": "96", "frames": "5", "shift_px_per_frame": "[0.5, 0.2]"},
}
STAGED = MEASUREMENT | {"synth": {"motion": '"slope"', "width_px": "96", "height_px": "96", "frames": "5",
                                  "slip_centre_px": "[79, 15]", "slip_radius_px": "50.0", "slip_deg": "2.0"}}
BOTH = MEASUREMENT | {
    "material.soil": {"model": '"linear_elastic"', "density_kg_m3": "1500.0", "young_pa": "1e5"},
    "mpm": {"initial_equilibrium": "false"},
    "boundary.base": {"line_m": "[[0.0, 0.016], [0.095, 0.016]]"},
}
CARRIED = MEASUREMENT | {
    "synth": {"motion": '"mpm"', "width_px": "96", "height_px": "96", "frames": "3"},
    "synth.material.soil": {"model": '"linear_elastic"', "density_kg_m3": "1500.0", "young_pa": "1e6"},
    "synth.mpm": {"end_s": "0.02", "output_rate_hz": "100.0"},
    "boundary.base": {"line_m": "[[0.0, 0.016], [0.095, 0.016]]"},
}
SUBMERGED = {"level_m": "0.1"}
POROUS = {"density_kg_m3": None, "porosity": "0.4", "permeability_m_s": "1e-6"}
WET = SIMULATION | {"material.soil": {k: v for k, v in (SIMULATION["material.soil"] | POROUS).items() if v}, "water": SUBMERGED,
                    "mpm": {"end_s": "0.005", "output_rate_hz": "400.0"}}
SPUN = SIMULATION | {"mpm": SIMULATION["mpm"] | {"gravity_m_s2": "[0.0, 0.0]"}, "centrifuge": {"radius_m": "1.0", "rate_rpm": "60.0"}}
THERMAL = {"grain_specific_heat_j_kg_k": "900.0", "conductivity_w_m_k": "2.0"}
HEATED = SIMULATION | {"material.soil": SIMULATION["material.soil"] | THERMAL, "heat": {}}
# Vectors of the same shift at the nodes of a grid, as each format has them.
VECTORS = {"vectors": {"path": '"csv_1.txt"', "format": '"csv"'}}
VECTOR_FILES = {
    "csv": ("x_px,y_px,u_px,v_px\n", "{},{},0.5,0.2\n"),
    "pivlab": ("x [px],y [px],u [px/frame],v [px/frame],Vector type [-]\n", "{},{},0.5,0.2,1\n"),
    "openpiv": ("# x\ty\tu\tv\tflags\tmask\n", "{}\t{}\t0.5\t0.2\t0\t0\n"),
    "dice": ("***\nCOORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y\n", "{},{},0.5,0.2\n"),
}
# Measured and simulated motion both begin at rest.
SOFTER = {"young_pa": "1e4"}
FROM_REST = {"synth": {"motion": '"mpm"', "shift_px_per_frame": None, "frames": "9"}, "material.soil": SOFTER,
             "synth.material.soil": SIMULATION["material.soil"] | SOFTER, "synth.mpm": {"initial_equilibrium": "false"}}
LENS = {"lens": '"brown"', "focal_px": "[900.0, 900.0]", "distortion": "[-0.01]"}
WINDOW = {"focal_px": "[900.0, 900.0]", "window_thickness_m": "0.005", "window_distance_m": "0.3"}
FILMED = MEASUREMENT | {"camera.motion": {"from": '"still_zone"', "zone_px": "[[2, 2], [93, 2], [93, 27], [2, 27]]", "subset_px": "15", "search_px": "8"}}
MARKS = {"from": '"targets"', "zone_px": None, "targets_px": "[[20, 14], [48, 14], [76, 14]]"}
# The case that a section's keys are tried in, and the section's name in it.
BASES = {
    "frames": MEASUREMENT, "preprocess": MEASUREMENT, "vectors": VECTORS, "camera": MEASUREMENT, "grid": MEASUREMENT, "region": SIMULATION, "mask": MEASUREMENT,
    "piv": MEASUREMENT, "np": MEASUREMENT, "material": SIMULATION, "mpm": SIMULATION, "boundary": SIMULATION,
    "body": SIMULATION, "contact": TWO_BODIES, "compare": BOTH, "compare.limits": BOTH, "report": SIMULATION,
    "output": SIMULATION, "synth": MEASUREMENT, "synth.texture": MEASUREMENT, "synth.material": CARRIED,
    "synth.mpm": CARRIED, "synth.camera": MEASUREMENT, "camera.motion": FILMED, "verify": MEASUREMENT,
    "centrifuge": SPUN, "water": WET, "heat": HEATED, "report.hardware": SIMULATION, "report.line": SIMULATION,
}
NAMES = {"region": "region.soil", "mask": "mask.label", "material": "material.soil", "initial": "initial.soil", "boundary": "boundary.side",
         "body": "body.tool", "contact": "contact.joint", "report.line": "report.line.middle", "synth.material": "synth.material.soil"}

SIDE = {"line_m": "[[0.0, 0.0], [0.0, 0.16]]", "type": '"roller"'}
TOP = {"line_m": "[[0.0, 0.08], [0.08, 0.08]]", "type": '"traction"', "traction_pa": "[0.0, -100.0]"}
TIED = {"line_m": "[[0.0, 0.0], [0.0, 0.16]]", "type": '"tied"', "across_m": "[0.08, 0.0]"}
BALL = {"circle_m": "[0.04, 0.115, 0.025]"}
AT_ONCE = {"mpm": {"initial_equilibrium": "false"}}
TARGETS = {"camera": {"metres_per_pixel": None, "points_px": "[[10, 10], [85, 10], [85, 85], [10, 85]]",
                      "points_m": "[[0.01, 0.085], [0.085, 0.085], [0.085, 0.01], [0.01, 0.01]]"}}
FLOODED = {"water": SUBMERGED, "material.soil": POROUS, "mpm": WET["mpm"]}
ZONE = "[[0.02, 0.02], [0.07, 0.02], [0.07, 0.06], [0.02, 0.06]]"
RAMP = {"gravity_from_m_s2": "[0.0, -5.0]", "gravity_ramp_s": "0.01"}
MU_I = SAND | {"model": '"mu_i"', "friction_deg": "25.0", "friction_flow_deg": "33.0", "grain_diameter_m": "1e-3", "cohesion_pa": None}
CLAY = {"model": '"tresca"', "shear_strength_pa": "1e5"}
CAM_CLAY = {"model": '"modified_cam_clay"', "young_pa": None, "friction_deg": "25.0", "lambda": "0.2", "kappa": "0.04", "void_ratio": "1.2",
            "preconsolidation_pa": "20e3"}
WATER = {"model": '"water"', "young_pa": None, "bulk_pa": "1e6"}
SOFT = SAND | {"softening_shape": "5.0", "friction_residual_deg": "30.0"}
DENSER = {"density_end_kg_m3": "1600.0", "density_until_s": "0.02"}
WEAKER = SAND | {"reduction_factor": "1.1"}
LINE = {"from_m": "[0.01, 0.04]", "to_m": "[0.07, 0.04]"}
FIELDS = '["displacement_x", "strain_1", "strain_dev_path", "velocity_magnitude", "J"]'

LAWS = {"linear_elastic": {}, "neo_hookean": {"model": '"neo_hookean"'}, "von_mises": CLAY | {"model": '"von_mises"'},
        "tresca": CLAY, "mohr_coulomb": SAND, "mohr_coulomb_smooth": SAND | {"model": '"mohr_coulomb_smooth"'},
        "drucker_prager": SAND | {"model": '"drucker_prager"'}, "modified_cam_clay": CAM_CLAY, "mu_i": MU_I, "water": WATER}
NO_EQUILIBRIUM = ("neo_hookean", "water", "mu_i")  # the last, without cohesion, does not stand as a block

# Of keys: values, or (value, what else the section holds, what other sections hold).
MATERIAL = {
    "model": [(f'"{law}"', keys, AT_ONCE if law in NO_EQUILIBRIUM else {}) for law, keys in LAWS.items()],
    "density_kg_m3": ["1700.0"], "young_pa": ["2e6"], "poisson": ["0.2"],
    "friction_deg": [("30.0", SAND)], "dilatancy_deg": [("5.0", SAND)], "cohesion_pa": [("900.0", SAND)],
    "tension_pa": [("10.0", SAND)], "shear_strength_pa": [("9e4", CLAY)],
    "friction_residual_deg": [("30.0", SOFT, AT_ONCE)], "cohesion_residual_pa": [("500.0", SOFT, AT_ONCE)], "softening_shape": [("2.0", SOFT, AT_ONCE)],
    "softening_length_m": [("0.03", SOFT, AT_ONCE)],
    "softening_average": [('"smeared"', SOFT | {"softening_length_m": "0.03"}, AT_ONCE), ('"nonlocal"', SOFT | {"softening_length_m": "0.03"}, AT_ONCE)],
    "friction_low_stress_deg": [("38.0", SAND | {"friction_half_pa": "500.0"})],
    "friction_half_pa": [("600.0", SAND | {"friction_low_stress_deg": "38.0"})],
    "dilatancy_fade": [("0.1", SAND | {"dilatancy_deg": "5.0"})],
    "apex_pa": [("20.0", SAND | {"model": '"mohr_coulomb_smooth"'})],
    "friction_flow_deg": [("34.0", MU_I, AT_ONCE)], "inertial_number": [("0.3", MU_I, AT_ONCE)], "grain_diameter_m": [("2e-3", MU_I, AT_ONCE)],
    "grain_density_kg_m3": [("2700.0", MU_I, AT_ONCE)],
    "lambda": [("0.25", CAM_CLAY)], "kappa": [("0.05", CAM_CLAY)], "void_ratio": [("1.3", CAM_CLAY)], "ocr": [("2.0", CAM_CLAY)],
    "preconsolidation_pa": [("30e3", CAM_CLAY)],
    "bulk_pa": [("2e6", WATER, AT_ONCE)], "viscosity_pa_s": [("1.0", WATER, AT_ONCE)],
    "density_end_kg_m3": [("1650.0", DENSER)], "density_from_s": [("0.005", DENSER)], "density_until_s": [("0.015", DENSER)],
    "reduction_factor": [("1.2", SAND)], "reduction_from_s": [("0.005", WEAKER)], "reduction_until_s": [("0.015", WEAKER)],
    "reduction_of": [('"strength"', WEAKER), ('"cohesion"', WEAKER | {"cohesion_pa": "1000.0"})],
    "removed_s": [("0.01", {}, {"region.soil": {"polygon_m": "[[0.0, 0.04], [0.08, 0.04], [0.08, 0.08], [0.0, 0.08]]"},
                                "region.below": {"polygon_m": "[[0.0, 0.0], [0.08, 0.0], [0.08, 0.04], [0.0, 0.04]]"},
                                "material.below": SIMULATION["material.soil"]})],
    "porosity": [("0.3", POROUS, {"water": SUBMERGED})], "permeability_m_s": [("1e-7", POROUS, {"water": SUBMERGED})],
    "permeability": [('"constant"', POROUS, {"water": SUBMERGED}), ('"kozeny_carman"', POROUS, {"water": SUBMERGED})],
    "drained": [("true", POROUS, {"water": SUBMERGED}), ("false", POROUS, {"water": SUBMERGED})],
}
# With [heat]: of the points, and of bands in soil that yields.
HEAT = {"heat": {}}
BAND = SAND | THERMAL | {"band_thickness_m": "0.01"}
MATERIAL |= {
    "grain_thermal_expansion_1_k": [("3e-5", THERMAL, HEAT)], "skeleton_thermal_expansion_1_k": [("3e-5", THERMAL, HEAT)],
    "grain_specific_heat_j_kg_k": [("800.0", THERMAL, HEAT)], "conductivity_w_m_k": [("1.5", THERMAL, HEAT)],
    "band_thickness_m": [("0.02", BAND, HEAT)], "band_compressibility_1_pa": [("1e-9", BAND, HEAT)],
    "band_exchange": [(f'"{exchange}"', BAND, HEAT) for exchange in ("deviation", "printed", "none")],
    "wetting_collapse": [("0.01", POROUS, {"water": SUBMERGED})],
}
MPM = {
    "gravity_m_s2": ["[0.1, -9.0]"], "gravity_from_m_s2": [("[0.0, -4.0]", RAMP)], "gravity_ramp_s": [("0.015", RAMP)],
    "k0": ["0.5"], "equilibrium_damping": ["0.6"], "damping": ["0.05"],
    "locking": ['"none"', '"fbar"', ('"selective"', {"shape": '"bilinear"'}), ('"full"', {"shape": '"bilinear"'})],
    "pic_per_s": [("5.0", {"transfer": '"flip"'})], "xpic_order": [("3", {"transfer": '"xpic"'})],
    "sleep_below_m_s": ["0.001"], "end_displacement_m": ["1.0"], "refine": ["2"], "end_s": ["0.01"], "output_rate_hz": ["200.0"],
    "domain_m": ["[[0.0, 0.0], [0.12, 0.12]]"], "per_element": ["9"],
    "pressure": [(scheme, {}, {"water": SUBMERGED, "material.soil": POROUS}) for scheme in ('"explicit"', '"projected"')],
}
VALUES = {
    "": {"name": ['"a name"']},
    "frames": {"path": [("DRAWN", {}, {"synth": None})], "first": ["1"], "last": ["3"], "stride": ["2"],
               "times": ['"even"', ('"stamps"', {"path": '"clip.avi"', "rate_hz": None}, {"synth": None})]},
    "vectors": {"path": ['"csv_1.txt"'], "format": [(f'"{name}"', {"path": f'"{name}_1.txt"'}) for name in VECTOR_FILES], "rate_hz": ["50.0"], "length_unit": ['"mm"']},
    "camera": {"origin_px": ["[10.0, 80.0]"], "points_px": [(TARGETS["camera"]["points_px"], {}, TARGETS)],
               "points_m": [(TARGETS["camera"]["points_m"], {}, TARGETS)], "length_unit": ['"ft"'], "metres_per_pixel": ["0.002"],
               "lens": ['"none"', ('"brown"', LENS), ('"fisheye"', LENS)], "focal_px": [("[800.0, 800.0]", LENS)], "centre_px": [("[48.0, 47.0]", LENS)],
               "distortion": [("[-0.02, 0.001]", LENS)], "lens_rms_px": [("0.05", LENS)], "window_thickness_m": [("0.01", WINDOW)],
               "window_distance_m": [("0.4", WINDOW)], "window_index": [("1.52", WINDOW)]},
    "camera.motion": {"from": [('"none"', {"zone_px": None}), '"still_zone"', ('"targets"', MARKS), ('"dominant"', {"zone_px": None})],
                      "zone_px": ["[[4, 4], [91, 4], [91, 27], [4, 27]]"], "zone_m": [("[[0.004, 0.066], [0.091, 0.066], [0.091, 0.091], [0.004, 0.091]]", {"zone_px": None})],
                      "targets_px": [("[[18, 14], [48, 14], [78, 14]]", MARKS)], "subset_px": ["17"]},
    "grid": {"spacing_px": ["6"], "spacing_m": [("0.008", {"spacing_px": None})], "margin_px": ["10"],
             "area_px": ["[[8, 8], [88, 88]]"], "area_m": ["[[0.01, 0.01], [0.085, 0.085]]"]},
    "region": {"polygon_m": ["[[0.0, 0.0], [0.06, 0.0], [0.06, 0.06], [0.0, 0.06]]"],
               "polygon_px": [("[[15, 79], [79, 79], [79, 39], [15, 39]]", {"polygon_m": None}, MEASUREMENT)],
               "material": [('"other"', {}, {"material.other": SAND})]},
    "mask": {"polygon_px": ["[[2, 2], [20, 2], [20, 20]]"], "polygon_m": ["[[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]]"],
             "circle_px": ["[10, 10, 6]"], "image": ['"mask.pgm"'],
             "images": ['"masks/*.pgm"'], "motion": [('"tool.csv"', {"circle_px": "[10, 10, 6]"})],
             "follow": [("true", {"polygon_px": "[[0, 0], [95, 0], [95, 34], [0, 34]]"}), ("false", {"circle_px": "[10, 10, 6]"})], "glare": ["0.98"],
             "follow_by": [('"texture"', {"polygon_px": "[[0, 0], [95, 0], [95, 34], [0, 34]]", "follow": "true"}),
                           ('"outline"', {"circle_px": "[48, 47, 15]", "follow": "true"}, {"frames": {"path": '"clip.avi"'}, "synth": None})],
             "air": [('"none"', {"circle_px": "[10, 10, 6]"}), '"texture"', '"still"'], "grow_px": [("2", {"glare": "0.98"})],
             "invert": [("true", {"polygon_px": "[[4, 4], [91, 4], [91, 91], [4, 91]]"}), ("false", {"circle_px": "[10, 10, 6]"})]},
    "piv": {"first_window_px": ["32"], "passes": ["2"], "window_px": ["24"], "order": [("0", {"smoothing": '"window"'}), ("2", {"smoothing": '"window"'})],
            "closure": ["2"]},
    "np": {"still_zone_px": ["[[20, 70], [60, 70], [60, 40], [20, 40]]"], "still_zone_m": [ZONE], "still_frames": ["2"],
           "drift_interval": [("2", {"drift": '"corrected"'})], "per_element": ["9"]},
    "material": MATERIAL,
    "mpm": MPM,
    "initial": {"velocity_m_s": ["[0.01, 0.0]"], "spin_rad_s": ["0.1"], "stress_pa": ["[-50.0, -100.0, -50.0, 0.0]"],
                "stress_gradient_pa_m": [("[1e3, 2e3, 1e3, 0.0]", {"stress_pa": "[0.0, 0.0, 0.0, 0.0]"})],
                "stress_level_m": [("0.08", {"stress_pa": "[-50.0, -100.0, -50.0, 0.0]"})], "stress_file": ['"stress.csv"'],
                "pressure_pa": [("200.0", {}, FLOODED)], "pressure_gradient_pa_m": [("-1e3", {"pressure_pa": "200.0"}, FLOODED)],
                "pressure_level_m": [("0.08", {"pressure_pa": "200.0", "pressure_gradient_pa_m": "-1e3"}, FLOODED)],
                "pressure_file": [('"pressure.csv"', {}, FLOODED)]},
    "boundary": {"line_m": [(SIDE["line_m"], SIDE)], "polygon_m": ["[[-0.01, -0.01], [0.01, -0.01], [0.01, 0.13], [-0.01, 0.13]]"],
                 "type": [('"fixed"', SIDE), ('"roller"', SIDE), ('"frictional"', SIDE), ('"absorbing"', SIDE, AT_ONCE),
                          ('"traction"', TOP), ('"tied"', TIED)],
                 "normal": [("[-1.0, 0.0]", SIDE)], "friction": [("0.3", SIDE | {"type": '"frictional"'})], "until_s": [("0.01", SIDE)],
                 "velocity_m_s": [("[0.001, 0.0]", SIDE | {"type": '"fixed"'})],
                 "motion": [('"motion.csv"', SIDE | {"type": '"fixed"'})], "withdraw_m_s": [("[0.0, 2.0]", SIDE)],
                 "withdraw_from_s": [("0.01", SIDE | {"withdraw_m_s": "[0.0, 2.0]"})], "traction_pa": [("[0.0, -50.0]", TOP)], "follows_face": [("true", TOP)],
                 "rise_s": [("0.01", TOP)], "across_m": [("[0.08, 0.0]", TIED)],
                 "pressure_pa": [("100.0", SIDE, FLOODED)], "drained": [("true", SIDE, FLOODED), ("false", SIDE, FLOODED)],
                 "water_level_m": [("0.05", SIDE, FLOODED)],
                 "flux_m_s": [("1e-5", SIDE, FLOODED)],
                 **{key: [(value, SIDE | more, HEAT | {"material.soil": THERMAL})] for key, value, more in (
                     ("temperature_c", "25.0", {}), ("heat_flux_w_m2", "10.0", {}), ("heat_transfer_w_m2_k", "5.0", {"temperature_c": "25.0"}))}},
    "body": {"circle_m": [BALL["circle_m"]], "polygon_m": ["[[0.01, 0.09], [0.07, 0.09], [0.07, 0.13], [0.01, 0.13]]"],
             "velocity_m_s": [("[0.0, -0.2]", BALL)], "friction": [("0.3", BALL)], "from_s": [("0.01", BALL)], "until_s": [("0.01", BALL)],
             "motion": [('"motion.csv"', BALL | {"velocity_m_s": None})], "force": [('"force.csv"', BALL | {"mass_kg_m": "5.0"})],
             "pivot_m": [("[0.04, 0.1]", BALL | {"angular_velocity_rad_s": "1.0"})],
             "mass_kg_m": [("5.0", BALL)], "mass_end_kg_m": [("6.0", BALL | {"mass_kg_m": "5.0", "mass_until_s": "0.02"})],
             "mass_from_s": [("0.01", BALL | {"mass_kg_m": "5.0", "mass_end_kg_m": "6.0", "mass_until_s": "0.02"})],
             "mass_until_s": [("0.02", BALL | {"mass_kg_m": "5.0", "mass_end_kg_m": "6.0"})],
             "turns": [("true", BALL | {"mass_kg_m": "5.0"}), ("false", BALL | {"mass_kg_m": "5.0"})]},
    "contact": {"regions": ['["above"]'], "against": [('["soil"]', {"regions": '["above"]'})], "friction": [("0.3", {"regions": '["above"]'})]},
    "compare": {"time_alignment": ['"none"', ('"onset"', {}, FROM_REST)], "reference_m": [ZONE], "fixed_zone_m": [ZONE], "points_m": ["[[0.04, 0.04]]"], "increments_outside_m": ["[0.04, 0.04, 0.01]"],
                "second_shift_m": ["[0.001, 0.0]"], "slope_base_m": ["0.016"], "mobilised_m": ["0.0001"], "measurement_uncertainty_m": ["1e-5"],
                "second_rotation_deg": ["1.0"], "second_scale": ["1.01"], "second_time_scale": ["1.01"], "time_offset_s": ["0.001"]},
    "compare.limits": {"run_out_m": [("1.0", {}, {"compare": {"slope_base_m": "0.016"}})],
                       "slope_angle_deg": [("90.0", {}, {"compare": {"slope_base_m": "0.016"}})]},
    "report": {"title": ['"A title"'], "times_s": ["[0.0, 0.01]"], "points_m": ["[[0.04, 0.04]]"], "fields": [FIELDS],
               "data_sets": ['["mpm"]'], "compare_runs": ['["TRUTH"]'], "gauge_m": ["0.03"]},
    "report.hardware": {key: ['"as written"'] for key in ("camera", "lens", "aperture", "exposure", "stand_off", "lighting", "pattern",
                                                          "feature_size", "other")},
    "report.line": {"type": [(f'"{kind}"', LINE) for kind in ("section", "extensometer")], "from_m": [(LINE["from_m"], LINE)], "to_m": [(LINE["to_m"], LINE)],
                    "field": [('"strain_dev"', LINE)]},
    "output": {"fields": [FIELDS]},
    "synth": {"motion": [('"none"', {"shift_px_per_frame": None}), '"affine"', ('"mpm"', {}, CARRIED), ('"slope"', {}, STAGED),
                         ('"record"', {"record": '"TRUTH"', "shift_px_per_frame": None})],
              "record": [('"TRUTH"', {"motion": '"record"', "shift_px_per_frame": None})],
              "gradient_per_frame": ["[0.001, 0.0, 0.0, -0.001]"], "shift_px_per_frame": ["[0.3, 0.1]"], "rotation_deg_per_frame": ["0.1"],
              "centre_px": ["[48.0, 48.0]"], "lose_texture_at": ["2"], "width_px": ["112"], "height_px": ["112"], "frames": ["3"],
              "settlement": [("0.01", {}, STAGED)], "collapse": [("0.02", {}, STAGED)], "slip_centre_px": [("[70, 20]", {}, STAGED)],
              "slip_radius_px": [("45.0", {}, STAGED)], "slip_band_px": [("12.0", {}, STAGED)], "slip_deg": [("1.0", {}, STAGED)]},
    "synth.texture": {"bits": ["8", "12", "16"], "peak_min": ["0.3"], "peak_max": ["0.7"], "noise": ["0.01"], "loss": ["0.05"],
                      "light_slope": ["0.1"], "light_change": ["0.1"], "blur_px": ["0.5"], "density_per_px": ["0.06"]},
    "synth.camera": {"bump_px": [("[2.0, -1.0]", {"bump_at": "2"})], "drift_px_per_frame": ["[0.2, 0.1]"], "still_px": ["[[0, 0], [95, 0], [95, 20], [0, 20]]"]},
    # The same lists as above, in another section.
    "synth.material": {key: [(*item[:2], {"synth.mpm": AT_ONCE["mpm"]}) if AT_ONCE in tuple(item) else item for item in items]
                       for key, items in MATERIAL.items()} |
                      {"porosity": [("0.3", POROUS, {"water": SUBMERGED})], "permeability_m_s": [("1e-7", POROUS, {"water": SUBMERGED})],
    "permeability": [('"constant"', POROUS, {"water": SUBMERGED}), ('"kozeny_carman"', POROUS, {"water": SUBMERGED})],
                       "drained": [("true", POROUS, {"water": SUBMERGED}), ("false", POROUS, {"water": SUBMERGED})]} |
                      {"removed_s": [("0.01", {}, {"region.soil": {"polygon_px": "[[15, 55], [79, 55], [79, 31], [15, 31]]"},
                                                   "region.below": {"polygon_px": "[[15, 79], [79, 79], [79, 55], [15, 55]]"},
                                                   "synth.material.below": SIMULATION["material.soil"]})]},
    "synth.mpm": MPM | {"pressure": [(scheme, {}, {"water": SUBMERGED, "synth.material.soil": POROUS}) for scheme in ('"explicit"', '"projected"')], "domain_m": ["[[0.0, 0.0], [0.095, 0.095]]"]},
    "centrifuge": {"axis": ['"across"', '"along"', ('"symmetry"', {"radius_m": None}, {"mpm": {"geometry": '"axisymmetric"'}})],
                   "at_m": ["[0.04, 0.04]"], "coriolis": ["true", "false"],
                   "rate_history": [("[[0.0, 30.0], [0.02, 60.0]]", {"rate_rpm": None})]},
    "water": {"level_history": [("[[0.0, 0.1], [0.02, 0.12]]", {"level_m": None})], "surface_m": ["[[0.0, 0.1], [0.12, 0.09]]"],
              "groundwater": [('"flow"', {}), ('"level"', {})], "inertia": [("true", {"level_m": None}, AT_ONCE), "false"],
              "start": [(f'"{start}"', {}) for start in ("hydrostatic", "seepage")] + [('"zero"', {"level_m": None}, AT_ONCE)],
              **{key: [(value, {}, HEAT | AT_ONCE | {"material.soil": THERMAL, "water": {"level_m": None}})] for key, value in (
                  ("thermal_expansion_1_k", "2e-4"), ("specific_heat_j_kg_k", "4200.0"))}},
    "verify": {"lost_share": [("0.5", {"displacement_rms_px": "5.0"})], "displacement_rms_px": ["5.0"], "strain_error": ["1.0"],
               "nodal_error": ["1.0"], "drift_px": ["5.0"], "drift_ratio": ["5.0"]},
}


def kind_and_range(text):
    """Of what stands in the brackets before the default: the type, and its choices or range."""
    if text in ("`true`", "`false`", "true or false"):
        return "true or false", ""
    if number := re.fullmatch(r"(whole )?(number|[<>≥≤] \S+?(?: and [<≤] \S+?)?|\S+ to \S+?)(?:, .*)?", text):
        return (number[1] or "") + "number", "" if number[2] == "number" else number[2]
    return (text, "") if text == "string" or text.startswith(("list", "[")) else ("string", text)


def rows(reference):
    """(section, key, type, allowed, default) of every key."""
    section, found_in = None, {}
    for line in reference.splitlines():
        if found := re.fullmatch(r"## \[(.*)\]", line):
            section = found[1].removesuffix(".NAME")
            found_in[section] = []
        elif line == "## Top level":
            section = ""
            found_in[section] = []
        elif mirrored := re.fullmatch(r"Keys: those of \[(.*)\]\.", line):
            for key in found_in[mirrored[1].removesuffix(".NAME")]:
                yield section, *key
        elif row := re.match(r"- `(\w+)` \((.*?)(?:; `(.*)`)?\): ", line) if section is not None else None:
            found_in[section].append((row[1], *kind_and_range(row[2]), row[3] or ""))
            yield section, *found_in[section][-1]


def values(section, key, kind, allowed, default):
    known = VALUES.get(section, {}).get(key)
    if known:
        return known
    if kind == "true or false":
        return ["true", "false"]
    if kind == "string" and allowed:
        return [f'"{choice}"' for choice in allowed.split(", ")]
    if kind in ("number", "whole number"):
        if default and not (float(default) == 0 and allowed.startswith(">")):
            return [default]
        whole = kind == "whole number"
        span = re.fullmatch(r"(\S+) to (\S+)", allowed)
        if span:
            low, high = float(span[1]), float(span[2])
            return [str(int((low + high) / 2)) if whole else repr((low + high) / 2)]
        return ["1" if whole else "1.0"]
    return None


def merge(case, more):
    for section, keys in more.items():
        if keys is None:
            case.pop(section, None)
            continue
        into = case.setdefault(section, {})
        for key, value in keys.items():
            if value is None:
                into.pop(key, None)
            else:
                into[key] = value


# Uncompressed video of five frames of 96 x 96 px: a dark disc, a pixel further to the right each time, before grains at rest.
def clip():
    random_grey = random.Random(5)
    grains = [[random_grey.randrange(110, 250) for _ in range(96)] for _ in range(96)]
    frames = []
    for k in range(5):
        rows = [[20 if (x - 48 - k) ** 2 + (y - 48) ** 2 <= 196 else grains[y][x] for x in range(96)] for y in range(96)]
        frames.append(b"".join(bytes([g, g, g]) for row in reversed(rows) for g in row))
    def chunk(name, data):
        return name + struct.pack("<I", len(data)) + data
    size, header = len(frames[0]), struct.pack("<IIIIIIIIII16x", 20000, 50 * 96 * 96 * 3, 0, 0x10, 5, 0, 1, 96 * 96 * 3, 96, 96)
    stream = b"vidsDIB " + struct.pack("<IHHIIIIIIIIhhhh", 0, 0, 0, 0, 1, 50, 0, 5, size, 0xFFFFFFFF, 0, 0, 0, 96, 96)
    form = struct.pack("<IiiHHIIiiII", 40, 96, 96, 1, 24, 0, size, 0, 0, 0, 0)
    head = chunk(b"LIST", b"hdrl" + chunk(b"avih", header) + chunk(b"LIST", b"strl" + chunk(b"strh", stream) + chunk(b"strf", form)))
    movie = chunk(b"LIST", b"movi" + b"".join(chunk(b"00db", f) for f in frames))
    index = chunk(b"idx1", b"".join(b"00db" + struct.pack("<III", 0x10, 4 + k * (size + 8), size) for k in range(5)))
    return chunk(b"RIFF", b"AVI " + head + movie + index)


def case_text(section, key, item, drawn):
    value, here, elsewhere = (item, {}, {}) if isinstance(item, str) else (*item, {}, {})[:3]
    if elsewhere and elsewhere.get("synth") and elsewhere.get("piv"):  # another case altogether
        case, elsewhere = copy.deepcopy(elsewhere), {}
        here = {k: v for k, v in here.items() if v is not None}
    else:
        case = copy.deepcopy(BASES.get(section, SIMULATION))
    name = NAMES.get(section, section)
    merge(case, {name: here} if name else {})
    merge(case, elsewhere)
    truth = pathlib.Path(drawn).parent.parent / "truth" / "record.h5"
    lines = [f'name = {value if section == "" else chr(34) + section + "." + key + chr(34)}']
    if name:
        case.setdefault(name, {})[key] = f'"{drawn}"' if value == "DRAWN" else value
    for title, keys in case.items():
        lines += ["", f"[{title}]"] + [f"{k} = {v}" for k, v in keys.items()]
    return "\n".join(lines).replace("TRUTH", str(truth)) + "\n"


def main():
    program, reference, each = sys.argv[1], pathlib.Path(sys.argv[2]).read_text(), int(sys.argv[3]) if len(sys.argv) > 3 else 1
    scratch = folder()
    faults, cases = [], []
    drawn = scratch / "drawn"
    drawn.mkdir()
    (drawn / "case.toml").write_text(case_text("synth", "frames", "5", ""))
    done = run(program, "synth", drawn, "--out", drawn / "out", "--quiet")
    assert done.returncode == 0, done.stderr
    for section, key, kind, allowed, default in rows(reference):
        items = values(section, key, kind, allowed, default)
        if not items:
            faults.append(f"[{section}] {key}: say in VALUES what a valid case with it looks like")
            continue
        if kind == "string" and allowed:
            tried = {(item if isinstance(item, str) else item[0]).strip('"') for item in items}
            if left := set(allowed.split(", ")) - tried:
                faults.append(f"[{section}] {key}: no case for {', '.join(sorted(left))}")
        cases += [(section, key, item) for item in items]
    assert len(cases) > 250, len(cases)  # the reference has been understood

    video = clip()

    def attempt(number):
        section, key, item = cases[number]
        there = scratch / str(number)
        there.mkdir()
        (there / "tool.csv").write_text("frame,right_px,down_px,turn_deg\n0,0,0,0\n4,2,1,3\n")
        (there / "clip.avi").write_bytes(video)
        (there / "masks").mkdir()
        for k in range(5):
            (there / "masks" / f"{k}.pgm").write_bytes(b"P5 96 96 255\n" + bytes([0] * 96 * (8 + k) + [255] * 96 * (88 - k)))
        (there / "mask.pgm").write_bytes(b"P5 96 96 255\n" + bytes([0] * 96 * 8 + [255] * 96 * 88))
        (there / "motion.csv").write_text("time_s,displacement_x_m,displacement_y_m\n0,0,0\n1,0.01,0\n")
        (there / "force.csv").write_text("time_s,force_y_n_m\n0,0\n1,-1\n")
        (there / "stress.csv").write_text("x_m,y_m,stress_xx_pa,stress_yy_pa,stress_zz_pa,stress_xy_pa\n" +
                                          "".join(f"{0.09 * i},{0.09 * j},-50,{-100 + 100 * j},-50,0\n" for i in (0, 1) for j in (0, 1)))
        (there / "pressure.csv").write_text("x_m,y_m,pressure_pa\n0,0,300\n0.09,0,300\n0,0.09,100\n0.09,0.09,100\n")
        for name, (head, row) in VECTOR_FILES.items():
            (there / f"{name}_1.txt").write_text(head + "".join(row.format(8 * i, 8 * j) for j in range(1, 7) for i in range(1, 7)))
        text = case_text(section, key, item, drawn / "out" / "frames" / "*.png")
        (there / "case.toml").write_text(text)
        done = run(program, "run", there, "--out", there / "out", "--threads", "1", "--quiet")
        good = done.returncode in (0, 3) and (there / "out" / "report.html").exists() and (there / "out" / "record.h5").exists()
        return "" if good else f"[{section}] {key} = {item if isinstance(item, str) else item[0]}: exit {done.returncode}: {done.stderr.strip()[-400:]}\n{text}"

    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(attempt, range(0, len(cases), each)))
    faults += [result for result in results if result]
    print(f"{len(results)} of {len(cases)} cases run, {len(faults)} faults")
    if faults:
        sys.exit("\n".join(faults))


main()
