/* SPDX-License-Identifier: MIT */
#include "constraint/body.h"

rb_vec3 rb_solver_turn_by_root(const rb_mat3 *root, rb_vec3 torque)
{
	return rb_mat3_apply_transposed(root, rb_mat3_apply(root, torque));
}
