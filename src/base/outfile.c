/* SPDX-License-Identifier: MIT */
/*
 * A file is written under a temporary name in the folder of its final one and renamed when
 * complete, so that a reader, a crash or a full disk never leaves half a file under the name. Write
 * errors are sticky in the stream, hence only publishing checks ferror and fclose. The modification
 * is atomic but not durable: nothing is synced here, since a recording that a power cut takes is
 * made again.
 */
#include "base/outfile.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"

enum rb_status rb_outfile_check(const char *name, unsigned how, struct rb_error *err)
{
	struct rb_place place;

	if (rb_place_open(&place, name, how, NULL) != RB_OK)
		return RB_OK; /* what is wrong with the name shows when it is created */
	const enum rb_status status = rb_place_check(&place, err);
	rb_place_release(&place);
	return status;
}

enum rb_status rb_outfile_probe(const char *name, unsigned how, struct rb_error *err)
{
	struct rb_outfile out;
	bool there;
	enum rb_status status = rb_place_probe(name, how | RB_PLACE_MAKE, &there, err);

	if (status || !there)
		return status;
	status = rb_outfile_open(&out, name, how, err);
	if (!status)
		rb_outfile_release(&out);
	return status;
}

enum rb_status rb_outfile_folders(const char *name, unsigned how, struct rb_error *err)
{
	struct rb_place place;
	const enum rb_status status = rb_place_open(&place, name, how | RB_PLACE_MAKE, err);

	rb_place_release(&place);
	return status;
}

enum rb_status rb_outfile_open(struct rb_outfile *out, const char *name, unsigned how,
                               struct rb_error *err)
{
	*out = (struct rb_outfile){.file = NULL};
	enum rb_status status = rb_place_open(&out->place, name, how, err);
	if (!status)
		status = rb_place_check(&out->place, err);
	if (status) {
		rb_outfile_release(out);
		return status;
	}
	const int descriptor = rb_place_create(&out->place, "", out->partial);
	if (descriptor >= 0)
		out->file = fdopen(descriptor, "w");
	if (out->file)
		return RB_OK;
	const int number = errno;
	if (descriptor >= 0)
		close(descriptor);
	else
		out->partial[0] = '\0';
	rb_outfile_release(out);
	return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", name, strerror(number));
}

/*
 * Why a write has failed, of which only that is known: the system is asked once more, at the end of
 * a file that goes anyway. 0: it does not say.
 */
static int failure_of(FILE *file)
{
	static const char zeros[1 << 16];

	for (int tries = 0; tries < 16; tries++)
		if (write(fileno(file), zeros, sizeof zeros) < 0)
			return errno;
	return 0;
}

enum rb_status rb_outfile_publish(struct rb_outfile *out, struct rb_error *err)
{
	RB_ASSERT(out->file && out->partial[0]);

	enum rb_status status = RB_OK;
	const bool broken = ferror(out->file) != 0;
	int number = broken ? failure_of(out->file) : 0;

	errno = 0;
	const bool closed = fclose(out->file) == 0;
	number = number ? number : errno;
	if (!closed || broken)
		status = RB_FAIL(err, RB_ERR_IO, "cannot write '%s': %s", out->place.path,
		                 number ? strerror(number) : "an earlier write failed");
	out->file = NULL;
	if (!status)
		status = rb_place_publish(&out->place, out->partial, err);
	if (!status)
		out->partial[0] = '\0';
	rb_outfile_release(out);
	return status;
}

void rb_outfile_release(struct rb_outfile *out)
{
	if (out->file)
		fclose(out->file);
	if (out->partial[0])
		rb_place_remove(&out->place, out->partial);
	rb_place_release(&out->place);
	*out = (struct rb_outfile){.place.folder = -1};
}
