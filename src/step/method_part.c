/* SPDX-License-Identifier: MIT */
/* The reason why a part is left out is that of the first absent feature that it needs. */
#include "step/method_part.h"

#include "model/features.h"

bool rb_method_part_is_used(const struct rb_method_part *part, const struct rb_model *model)
{
	return part->need == 0 || (model->features & part->need) != 0;
}

const char *rb_method_part_why_not(const struct rb_method_part *part, const struct rb_model *model)
{
	int count = 0;
	const struct rb_feature_row *row = rb_feature_rows(&count);

	for (int k = 0; k < count && !rb_method_part_is_used(part, model); k++)
		if (row[k].bit & part->need)
			return row[k].absent;
	return "";
}
