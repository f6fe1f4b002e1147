#include "comp/kinematics_chain.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define RAD_PER_DEG 0.017453292519943295

typedef double vector_t[3];
typedef double matrix_t[3][3];

/* An axis as the unknowns have it, at one angle, and the part of the chain that it carries. */
typedef struct {
    vector_t direction;
    vector_t point;
    matrix_t turn;
    vector_t carried; /* from the axis's point, before the axis turns it */
} joint_t;

static void cross(const double *a, const double *b, vector_t out)
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void apply(double m[3][3], const double *v, vector_t out)
{
    for (int k = 0; k < 3; k++) {
        out[k] = m[k][0] * v[0] + m[k][1] * v[1] + m[k][2] * v[2];
    }
}

/* Rodrigues: R = I + sin θ·[n] + (1 − cos θ)·[n]². */
static void rotation(const double *n, double angle_rad, double out[3][3])
{
    double s = sin(angle_rad);
    double half = sin(0.5 * angle_rad);
    double c = 2.0 * half * half;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3;
        int j = (k + 2) % 3;
        out[k][k] = 1.0 - c * (n[i] * n[i] + n[j] * n[j]);
        out[i][j] = c * n[i] * n[j] - s * n[k];
        out[j][i] = c * n[i] * n[j] + s * n[k];
    }
}

int32_t kinematics_chain_coordinate(const kinematics_axis_t *axis, int32_t i)
{
    int32_t own = axis->letter - 'A';
    int32_t first = own == 0 ? 1 : 0;
    int32_t second = own == 2 ? 1 : 2;
    return i == KINEMATICS_CHAIN_ZERO ? own : (i % 2 == 0 ? first : second);
}

static void tilted(const kinematics_axis_t *axis, const double *errors, vector_t direction)
{
    vector_t by = {0.0, 0.0, 0.0};
    by[kinematics_chain_coordinate(axis, KINEMATICS_CHAIN_TILT)] = errors[KINEMATICS_CHAIN_TILT];
    by[kinematics_chain_coordinate(axis, KINEMATICS_CHAIN_TILT + 1)] =
        errors[KINEMATICS_CHAIN_TILT + 1];
    double angle_rad = sqrt(by[0] * by[0] + by[1] * by[1] + by[2] * by[2]);
    memcpy(direction, axis->direction, sizeof(vector_t));
    if (angle_rad > 0.0) {
        matrix_t turn;
        for (int k = 0; k < 3; k++) {
            by[k] /= angle_rad;
        }
        rotation(by, angle_rad, turn);
        apply(turn, axis->direction, direction);
    }
}

/* Carry `place` through the axis, and keep what the derivatives need. */
static void carry(const kinematics_axis_t *axis, const double *errors, double angle_deg,
                  vector_t place, joint_t *joint)
{
    tilted(axis, errors, joint->direction);
    memcpy(joint->point, axis->point_mm, sizeof(vector_t));
    joint->point[kinematics_chain_coordinate(axis, KINEMATICS_CHAIN_OFFSET)] +=
        errors[KINEMATICS_CHAIN_OFFSET];
    joint->point[kinematics_chain_coordinate(axis, KINEMATICS_CHAIN_OFFSET + 1)] +=
        errors[KINEMATICS_CHAIN_OFFSET + 1];
    rotation(joint->direction, angle_deg * RAD_PER_DEG + errors[KINEMATICS_CHAIN_ZERO],
             joint->turn);
    for (int k = 0; k < 3; k++) {
        joint->carried[k] = place[k] - joint->point[k];
    }
    apply(joint->turn, joint->carried, place);
    for (int k = 0; k < 3; k++) {
        place[k] += joint->point[k];
    }
}

static const double *errors_of(const double *unknowns, int32_t axis)
{
    return &unknowns[KINEMATICS_NUISANCES + KINEMATICS_OF_AXIS * axis];
}

/* Carry sphere or tip from its end of the chain to the frame of the machine. */
static void carry_all(const kinematics_machine_t *machine, bool head, const double *unknowns,
                      const double *angle_deg, vector_t place, joint_t *joints)
{
    memcpy(place, &unknowns[head ? 3 : 0], sizeof(vector_t));
    for (int32_t j = machine->axes_count - 1; j >= 0; j--) {
        if ((machine->axes[j].is_head != 0) == head) {
            carry(&machine->axes[j], errors_of(unknowns, j), angle_deg[j], place, &joints[j]);
        }
    }
}

/* The sphere, less how far the head has carried the tip. */
static void place_all(const kinematics_machine_t *machine, const double *unknowns,
                      const double *angle_deg, vector_t position_mm, joint_t *joints)
{
    vector_t tip;
    carry_all(machine, false, unknowns, angle_deg, position_mm, joints);
    carry_all(machine, true, unknowns, angle_deg, tip, joints);
    for (int k = 0; k < 3; k++) {
        position_mm[k] -= tip[k] - unknowns[3 + k];
    }
}

void kinematics_chain_position(const kinematics_machine_t *machine, const double *unknowns,
                               const double *angle_deg, double position_mm[3])
{
    joint_t joints[KINEMATICS_AXES_MAX];
    place_all(machine, unknowns, angle_deg, position_mm, joints);
}

/* How the axis moves what it carries, by its own unknown `i`: offset (I − R)·e; tilt
 * e × R·v − R·(e × v), because a turn of the axis is R' = E·R·E⁻¹; zero n × R·v. */
static void joint_slope(const kinematics_axis_t *axis, joint_t *joint, int32_t i, vector_t out)
{
    vector_t unit = {0.0, 0.0, 0.0};
    vector_t turned;
    vector_t inner;
    unit[kinematics_chain_coordinate(axis, i)] = 1.0;
    if (i < KINEMATICS_CHAIN_TILT) {
        apply(joint->turn, unit, turned);
        for (int k = 0; k < 3; k++) {
            out[k] = unit[k] - turned[k];
        }
        return;
    }
    apply(joint->turn, joint->carried, turned);
    if (i == KINEMATICS_CHAIN_ZERO) {
        cross(joint->direction, turned, out);
        return;
    }
    cross(unit, joint->carried, inner);
    cross(unit, turned, out);
    apply(joint->turn, inner, turned);
    for (int k = 0; k < 3; k++) {
        out[k] -= turned[k];
    }
}

static void multiply(double a[3][3], double b[3][3])
{
    matrix_t product;
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) {
            product[k][i] = a[k][0] * b[0][i] + a[k][1] * b[1][i] + a[k][2] * b[2][i];
        }
    }
    memcpy(a, product, sizeof product);
}

/* The slopes of the table's or the head's part, from the bed or the ram outwards. */
static void part_slopes(const kinematics_machine_t *machine, bool head, joint_t *joints,
                        double slopes[3][KINEMATICS_UNKNOWNS_MAX])
{
    double   sign = head ? -1.0 : 1.0;
    matrix_t before = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    for (int32_t j = 0; j < machine->axes_count; j++) {
        if ((machine->axes[j].is_head != 0) != head) {
            continue;
        }
        for (int32_t i = 0; i < KINEMATICS_OF_AXIS; i++) {
            vector_t own;
            vector_t seen;
            joint_slope(&machine->axes[j], &joints[j], i, own);
            apply(before, own, seen);
            for (int k = 0; k < 3; k++) {
                slopes[k][KINEMATICS_NUISANCES + KINEMATICS_OF_AXIS * j + i] = sign * seen[k];
            }
        }
        multiply(before, joints[j].turn);
    }
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) {
            double at_zero = head && k == i ? 1.0 : 0.0;
            slopes[k][(head ? 3 : 0) + i] = at_zero + sign * before[k][i];
        }
    }
}

void kinematics_chain_slopes(const kinematics_machine_t *machine, const double *unknowns,
                             const double *angle_deg, double position_mm[3],
                             double slopes[3][KINEMATICS_UNKNOWNS_MAX])
{
    joint_t joints[KINEMATICS_AXES_MAX];
    place_all(machine, unknowns, angle_deg, position_mm, joints);
    part_slopes(machine, false, joints, slopes);
    part_slopes(machine, true, joints, slopes);
}
