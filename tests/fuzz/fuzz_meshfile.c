/* SPDX-License-Identifier: MIT */
/*
 * Fuzz target: any bytes as a mesh; the first one says which kind of file. What must hold: reading says RB_OK with corners that
 * differ, or RB_ERR_SCENE with a reason, and stays within the room that it asks for.
 */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "geom/meshfile.h"

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size);

int LLVMFuzzerTestOneInput(const unsigned char *bytes, size_t size)
{
	struct rb_error err = {0};
	size_t count = 0;

	if (size == 0)
		return 0;
	const enum rb_meshfile_kind kind = bytes[0] % 2 ? RB_MESHFILE_STL : RB_MESHFILE_OBJ;
	char *const text = rb_memory_take(size, 1);
	rb_vec3 *const points = rb_memory_take(rb_meshfile_corners_max(kind, size - 1),
	                                       sizeof *points);
	if (!text || !points)
		abort();
	memcpy(text, bytes + 1, size - 1);
	const enum rb_status status = rb_meshfile_read(kind, text, size - 1, points, &count, &err);
	if (status ? status != RB_ERR_SCENE || err.text[0] == '\0' : count == 0)
		abort();
	rb_memory_free(points);
	rb_memory_free(text);
	return 0;
}
