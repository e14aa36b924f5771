#ifndef MOMA_PLUGIN_H
#define MOMA_PLUGIN_H

/**
 * Controllers of one's own for moma's evaluation: a shared library with the six functions at the end of this file,
 * named in a suite by `method: plugin`. Only C types cross the border, so that compiler, standard library and language
 * of the plugin are its author's choice. In C++, plugin/plugin.h does all of this for a class with moma's step
 * interface.
 *
 * Units are metres, radians and seconds; all vectors and matrices are in world axes W (z up) unless they say otherwise;
 * matrices are row by row; six-vectors are [angular; linear]. Configurations are (x, y, phi) of the base and one value
 * per joint; velocities (v, omega | qdot) for a differential base, (v_x, v_y, omega | qdot) in the base's axes for an
 * omnidirectional one, qdot alone for a fixed one.
 *
 * Everything a function is given belongs to the caller and is valid during the call only.
 */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Raised whenever a function or struct below changes, and with it the protocol of processes
 * (plugin/process/session.h). A library made for another version is refused. */
#define MOMA_PLUGIN_ABI 8

#if defined(_WIN32)
#define MOMA_PLUGIN_EXPORT __declspec(dllexport)
#else
#define MOMA_PLUGIN_EXPORT __attribute__((visibility("default")))
#endif

enum moma_base_type {
  MOMA_BASE_FIXED = 0,
  MOMA_BASE_DIFFERENTIAL = 1,
  MOMA_BASE_OMNIDIRECTIONAL = 2,
  MOMA_BASE_TYPES = 3 /**< their number */
};

/** What a plugin is told once, before any motion. */
typedef struct moma_plugin_setup {
  const char* robot;         /**< JSON: everything about the robot (robots.md), its URDF's text and hulls included */
  const char* parameters;    /**< JSON: the suite's `parameters`, {} where there are none */
  double control_period;     /**< [s] */
  int32_t base_type;         /**< enum moma_base_type */
  size_t num_joints;         /**< joints that are controlled, from base to tip */
  size_t num_velocities;     /**< those of the base, then the joints */
  const char* const* joints; /**< num_joints names */
  const double* lower;       /**< num_joints limits; -inf and inf for continuous joints */
  const double* upper;
  const double* ready;           /**< num_joints */
  const double* velocity_limits; /**< num_velocities; the largest absolute values */
} moma_plugin_setup;

enum moma_shape_kind {
  MOMA_SPHERE = 0,   /**< size: radius */
  MOMA_BOX = 1,      /**< size: full edge lengths */
  MOMA_CYLINDER = 2, /**< size: radius, length along z */
  MOMA_CAPSULE = 3,  /**< size: radius, length along z without the caps */
  MOMA_CONVEX = 4    /**< vertices and triangles */
};

/** What does not change about an object while a motion lasts. */
typedef struct moma_object_shape {
  const char* name;
  int32_t kind; /**< enum moma_shape_kind */
  double size[3];
  size_t num_vertices;
  const double* vertices; /**< 3 for each, in the object's frame */
  size_t num_triangles;
  const int32_t* triangles; /**< 3 indices for each, counter-clockwise seen from outside */
} moma_object_shape;

/*
 * Observations and answers are 64-bit floating-point numbers: truths are 1 or 0, words the values of an
 * enumeration. They stand in the order in which processes get them (docs/reference/process-protocol.md). What is sensed
 * is written here from its description, controller/step_described.h.
 */

typedef struct moma_object_state {
  /* clang-format off */
/* numbers of an object */
  double position[3]; /**< [m] */
  double rotation[9]; /**< 3 x 3, by rows */
  double twist[6]; /**< [rad/s, m/s] [angular; linear], at the object's origin */
  double visible; /**< 1 or 0; where it is not, the rest means nothing */
  double has_covariance; /**< 0: there is none, its numbers mean nothing */
  double position_covariance[9]; /**< [m^2] covariance of the origin's position */
  double velocity_covariance[9]; /**< [(m/s)^2] covariance of the linear velocity */
/* end of numbers of an object */
  /* clang-format on */
} moma_object_state;

/** What a controller may know at one step: sensed, never the simulator's truth. */
typedef struct moma_observation {
  /* clang-format off */
/* numbers of an observation */
  double time; /**< [s] since the start of the motion; where a period was missed, later by two */
  double base[3]; /**< [m, m, rad] x, y, phi */
  double goal_position[3]; /**< [m] */
  double goal_rotation[9]; /**< 3 x 3, by rows */
  double goal_twist[6]; /**< [rad/s, m/s] [angular; linear], the goal's own; 0 where it stands still */
  double goal_stop; /**< 1 or 0; where it is not, the hand passes through on its way on */
  double goal_free[6]; /**< 1: the rotation about, or the place along, this axis of the goal is free; rx ry rz x y z */
  double has_next; /**< 0: there is none, its numbers mean nothing */
  double position_next[3]; /**< [m] */
  double rotation_next[9]; /**< 3 x 3, by rows */
  double twist_next[6]; /**< [rad/s, m/s] [angular; linear], the goal's own; 0 where it stands still */
  double stop_next; /**< 1 or 0; where it is not, the hand passes through on its way on */
  double free_next[6]; /**< 1: the rotation about, or the place along, this axis of the goal is free; rx ry rz x y z */
  double has_upright; /**< 0: there is none, its numbers mean nothing */
  double axis_upright[3]; /**< axis of E, of any length but 0, that stays near the vertical */
  double angle_upright; /**< [rad] largest angle between that axis and the vertical */
  double has_carried; /**< 0: there is none, its numbers mean nothing */
  double object_carried; /**< its index among the objects */
  double position_carried[3]; /**< [m] */
  double rotation_carried[9]; /**< 3 x 3, by rows */
  double support_carried; /**< index of the object that it has not been lifted clear of; -2: the floor, -1: none */
  double touch_carried[6]; /**< indices of robot shapes that it may touch beside those of the hand; -1: none */
/* end of numbers of an observation */
  /* clang-format on */
  const double* q;
  const double* qdot;               /**< measured, num_velocities */
  const moma_object_state* objects; /**< in the order of moma_plugin_start() */
  size_t num_objects;
  const double* numbers; /**< all of it once more, one number after the other */
  size_t num_numbers;
} moma_observation;

enum moma_status { MOMA_SOLVED = 0, MOMA_INFEASIBLE = 1, MOMA_MAX_ITERATIONS = 2, MOMA_INVALID_INPUT = 3 };
enum moma_fallback { MOMA_NONE = 0, MOMA_NO_ACCELERATION = 1, MOMA_RELAXED = 2, MOMA_BRAKE = 3 };

/** The answer. Everything but `command` is filled in with what its comment says, and may be left so. */
typedef struct moma_step_result {
  double* command;       /**< num_velocities numbers to write, all finite; NaN where left out, which ends the trial */
  double status;         /**< enum moma_status: MOMA_SOLVED */
  double fallback;       /**< enum moma_fallback: MOMA_NONE; others for longer than the suite allows end the trial */
  double slack[6];       /**< 0 */
  double least_distance; /**< as the controller sees it: inf */
  double rows;           /**< of its optimization, if any: 0 */
  double active_rows;    /**< 0 */
  double iterations;     /**< 0 */
  double solve_seconds;  /**< 0; never part of a comparison */
} moma_step_result;

/*
 * The functions of a plugin. `error` has room for `error_size` bytes: where a function fails it may leave there what
 * was wrong, ending in 0. moma_plugin_open() and moma_plugin_close() are never called at the same time as anything else
 * of the same plugin; controllers of one plugin are started, stepped and stopped by several threads at once, each
 * controller by one thread at a time. The same calls must give the same answers.
 */

/** MOMA_PLUGIN_ABI. */
MOMA_PLUGIN_EXPORT uint32_t moma_plugin_abi(void);

/** Reads and checks the parameters for this robot. NULL: refused. */
MOMA_PLUGIN_EXPORT void* moma_plugin_open(const moma_plugin_setup* setup, char* error, size_t error_size);
MOMA_PLUGIN_EXPORT void moma_plugin_close(void* plugin);

/** A controller for one motion among these objects. NULL: failed. */
MOMA_PLUGIN_EXPORT void* moma_plugin_start(void* plugin, const moma_object_shape* objects, size_t num_objects,
                                           char* error, size_t error_size);
/** The command for the next control period. Not 0: failed; the trial ends there, with outcome `error`. */
MOMA_PLUGIN_EXPORT int moma_plugin_step(void* controller, const moma_observation* observation, moma_step_result* result,
                                        char* error, size_t error_size);
MOMA_PLUGIN_EXPORT void moma_plugin_stop(void* controller);

#ifdef __cplusplus
}
#endif

#endif
