/* SPDX-License-Identifier: MIT */
/*
 * On a rasteriser in software, branches are masks: both sides are always computed. So there are
 * none; what a body does not need is left out of its program by the preprocessor.
 *
 * A uniform costs it more than anything but a texture (a vec4 1.4 ns a fragment, six times a flat
 * varying and eight times a sum). So fragments read none: what stays the same for a film is written
 * into the texts as numbers (defines of film/bodies and film/painter: ZENITH, AMBIENT_UP, LIGHTS,
 * ...), and what changes is handed on by the vertex shader, CARRY and SEND. Few polygons then,
 * since each carries all that.
 */
#include "film/shaders.h"

const char rb_shader_scene[] =
	"layout(std140) uniform Scene {\n"
	"	mat4 projection;\n"
	"	vec4 window, depth, pixel, axes[3];\n"
	"	vec4 place[8];\n"
	"	vec4 shadow[32];\n"
	"};\n"
	"vec3 turned(vec3 p)\n" /* to world axes */
	"{\n"
	"	return p.x * axes[0].xyz + p.y * axes[1].xyz + p.z * axes[2].xyz;\n"
	"}\n"
	"#define PI 3.14159265358979\n"
	/*
	 * The line of sight through a fragment, START + t WAY, 1 along the camera's axis; through a
	 * point, SIGHT. All begin at the eye, which is the origin, or they are PARALLEL. DEPTH of
	 * what is so far along the axis.
	 */
	"#define SEND_WAY_AT(at) way_ = vec4(turned(vec3(window.xy, at)), 0.0); \\\n"
	"	way_x_ = vec4(window.z * axes[0].xyz, 0.0); way_y_ = vec4(window.w * axes[1].xyz, "
	"0.0)\n"
	"#define THROUGH (way_.xyz + gl_FragCoord.x * way_x_.xyz + gl_FragCoord.y * way_y_.xyz)\n"
	"#ifdef PARALLEL\n"
	"#define AXIS(way) flat way vec4 axis_;\n"
	"#define SEND_AXIS axis_ = -axes[2];\n"
	"#define SEND_WAY SEND_AXIS SEND_WAY_AT(0.0)\n"
	"#define START THROUGH\n"
	"#define WAY axis_.xyz\n"
	"#define SIGHT(p) axis_.xyz\n"
	"#define DEPTH(ab, far) (ab.x + ab.y * far)\n"
	"#else\n"
	"#define AXIS(way)\n"
	"#define SEND_AXIS\n"
	"#define SEND_WAY SEND_WAY_AT(-1.0)\n"
	"#define START vec3(0.0)\n"
	"#define WAY THROUGH\n"
	"#define SIGHT(p) normalize(p)\n"
	"#define DEPTH(ab, far) (ab.x + ab.y / far)\n"
	"#endif\n";

/* ---- light ---- */

/*
 * Blinn's half vector (1977), normalised for its exponent as in Akenine-Moller et al., Real-Time
 * Rendering, and 4 % of reflection: that of plastics.
 */
const char rb_shader_light[] =
	"CARRY(in)\n"
	"uniform sampler2DShadow map0, map1, map2, map3, map4, map5, map6, map7;\n"
	/* Straight up to the knee, then bent so that nothing reaches 1 with an edge. */
	"vec3 tone(vec3 c)\n"
	"{\n"
	"	vec3 over = max(c - 0.62, 0.0);\n"
	"	return min(c, 0.62) + over / (1.0 + over * (1.0 / 0.40));\n"
	"}\n"
	"vec3 sky(vec3 way)\n"
	"{\n"
	"	float h = dot(way, UP);\n"
	"	float rise = 1.0 - max(h, 0.0), fall = 1.0 - max(-h, 0.0);\n"
	"	rise *= rise * rise;\n"
	"	fall *= fall * fall; fall *= fall;\n"
	"	vec3 above = mix(ZENITH, HORIZON, rise), below = mix(NADIR, HORIZON, fall);\n"
	"	return h < 0.0 ? below : above;\n"
	"}\n"
	"vec3 shine(vec3 N, vec3 V, vec3 L, vec3 albedo, float gloss)\n"
	"{\n"
	"#ifdef GLOSS\n"
	"	vec3 H = normalize(L + V);\n"
	"	float s = max(dot(N, H), 1e-4);\n"
	"	return albedo + 0.04 * (0.125 * gloss + 1.0) * exp2(gloss * log2(s));\n"
	"#else\n"
	"	return albedo;\n"
	"#endif\n"
	"}\n"
	/*
	 * The map is filtered by the library, 2 x 2 texels; four of these make a soft edge, two one
	 * without teeth.
	 */
	"float filtered(sampler2DShadow map, vec3 q)\n"
	"{\n"
	"	q.z = min(q.z, 1.0);\n"
	"#ifdef FINE\n"
	"	const float d = TEXEL;\n"
	"	return 0.25 * (texture(map, q + vec3(-0.35 * d, -d, 0)) + texture(map, q + vec3(d, "
	"-0.35 * d, 0))\n"
	"		+ texture(map, q + vec3(0.35 * d, d, 0)) + texture(map, q + vec3(-d, 0.35 "
	"* d, 0)));\n"
	"#elif defined(FAIR)\n"
	"	const vec3 d = vec3(0.6, 0.3, 0.0) * TEXEL;\n"
	"	return 0.5 * (texture(map, q - d) + texture(map, q + d));\n"
	"#else\n"
	"	return texture(map, q);\n"
	"#endif\n"
	"}\n"
	"float seen(sampler2DShadow map, vec4 x, vec4 y, vec4 z, vec4 w, vec3 P)\n"
	"{\n"
	"	float scale = dot(w.xyz, P) + w.w;\n"
	"	vec3 q = vec3(dot(x.xyz, P) + x.w, dot(y.xyz, P) + y.w, dot(z.xyz, P) + z.w);\n"
	"	float far = filtered(map, q / scale);\n"
	"	return scale > 0.0 ? far : 1.0;\n"
	"}\n"
	"float cone(vec3 W, vec3 axis, float edge, float rise)\n"
	"{\n"
	"	float f = clamp((dot(W, axis) - edge) * rise, 0.0, 1.0);\n"
	"	return f * f * (3.0 - 2.0 * f);\n"
	"}\n"
	"vec3 lit(vec3 P, vec3 N, vec3 V, vec3 albedo, float gloss)\n"
	"{\n"
	"	vec3 sum = albedo * mix(AMBIENT_DOWN, AMBIENT_UP, 0.5 + 0.5 * dot(N, UP));\n"
	"#define ADD(colour, L, part) { float f = max(dot(N, L), 0.0); \\\n"
	"	sum += colour * (f * (part)) * shine(N, V, L, albedo, gloss); }\n"
	"#define SUN(colour, at) ADD(colour, at, 1.0)\n"
	"#define SUN_SHADOW(colour, at, side, top, map, a, b) ADD(colour, at, \\\n"
	"	filtered(map, vec3(dot(P, side), dot(P, top), dot(P, at)) * a.xxw + vec3(a.yz, "
	"b.x)))\n"
	"#define LAMP_IN(colour, at, part) { vec3 D = at.xyz - P; float d2 = dot(D, D); vec3 W = D "
	"* inversesqrt(d2); \\\n"
	"	ADD(colour, W, (part) * 2.0 / (1.0 + d2 * at.w)) }\n"
	"#define LAMP(colour, at) LAMP_IN(colour, at, 1.0)\n"
	"#define LAMP_SHADOW(colour, at, map, x, y, z, w) LAMP_IN(colour, at, seen(map, x, y, z, "
	"w, P))\n"
	"#define SPOT_IN(colour, at, axis, edge, rise, part) LAMP_IN(colour, at, cone(W, axis, "
	"edge, rise) * (part))\n"
	"#define SPOT(colour, at, axis, edge, rise) SPOT_IN(colour, at, axis, edge, rise, 1.0)\n"
	"#define SPOT_SHADOW(colour, at, axis, edge, rise, map, x, y, z, w) \\\n"
	"	SPOT_IN(colour, at, axis, edge, rise, seen(map, x, y, z, w, P))\n"
	"	LIGHTS\n"
	"	return sum;\n"
	"}\n";

/* ---- patterns ---- */

/* 0 and 1 are the two colours of a pattern; edges are as wide as a pixel. */
const char rb_shader_pattern[] =
	"float edge(float f)\n"
	"{\n"
	"	return clamp(0.5 + f / (fwidth(f) + 1e-9), 0.0, 1.0);\n"
	"}\n"
	/*
	 * Squares of side 1 averaged over a box w (the integral of a square wave, as I. Quilez does
	 * it).
	 */
	"vec2 wave(vec2 p, vec2 w)\n"
	"{\n"
	"	return 2.0 * (abs(fract((p - 0.5 * w) * 0.5) - 0.5) - abs(fract((p + 0.5 * w) * "
	"0.5) - 0.5)) / w;\n"
	"}\n"
	"vec2 footprint(vec2 p)\n"
	"{\n"
	"	return abs(dFdx(p)) + abs(dFdy(p)) + 1e-4;\n"
	"}\n"
	/* Six sectors by sin 3 phi, a cap at either pole. */
	"vec3 beachball(vec3 n, vec3 paint)\n"
	"{\n"
	"	float f = n.y * (3.0 * n.x * n.x - n.y * n.y);\n"
	"	vec3 c = mix(vec3(0.86), paint, edge(f));\n"
	"	return mix(c, n.z < 0.0 ? vec3(0.86) : paint * 0.45, edge(abs(n.z) - 0.955));\n"
	"}\n";

/* ---- spheres ---- */

/*
 * A sphere is a polygon around the circle in which lines of sight touch it; each fragment casts its
 * own ray. All lengths are in radii and from its centre, where single precision has digits enough
 * at any distance.
 *
 * The disc in that circle lies within the sphere and meets every ray that does. So where two bodies
 * share no point, it is in front of the other one or behind it just as the sphere's surface is, and
 * its depth will do: then what is hidden is thrown away before it is computed. EXACT spheres, which
 * cut something, have depths of their own.
 *
 * An edge is smooth in one of two ways: SAMPLES says which samples of a pixel the ray's neighbours
 * hit; with SOFT only whole pixels are drawn at first, and when all else is there a ring (RIM) in
 * the plane of the disc mixes in the others by how much of them is covered; EXACT spheres need no
 * other one, since their edge is that of the disc.
 */
const char rb_shader_sphere_vertex[] =
	"layout(location = 0) in vec4 ball;\n"  /* centre, radius */
	"layout(location = 1) in vec4 turn;\n"  /* world to object coordinates: x, y, z, w */
	"layout(location = 2) in vec4 paint;\n" /* colour, exponent of the highlight */
	"out vec3 ray;\n"
	"flat out vec4 centre;\n" /* the exponent of the highlight */
	"flat out vec4 body;\n"   /* colour, radius */
	"flat out vec4 spin;\n"   /* world to object coordinates */
	"CARRY(out)\n"
	"AXIS(out)\n"
	"#ifdef DEEP\n"
	"flat out vec4 sent_depth, sent_back;\n"
	"#endif\n"
	"void main()\n"
	"{\n"
	"#ifdef PARALLEL\n"
	"	const float lean = 0.0;\n"
	"	const vec3 n = vec3(0.0, 0.0, -1.0);\n"
	"	float margin = pixel.x / ball.w;\n" /* of a pixel */
	"#else\n"
	"	float d = length(ball.xyz), lean = ball.w / d, margin = pixel.x / lean;\n"
	"	vec3 n = ball.xyz / d;\n"
	"#endif\n"
	"	vec3 a = normalize(abs(n.y) < 0.9 ? vec3(-n.z, 0.0, n.x) : vec3(0.0, n.z, -n.y)), "
	"b = cross(n, a);\n"
	"	float reach = sqrt(max(1.0 - lean * lean, 0.0));\n"
	"#ifdef RIM\n"
	"	float angle = float(gl_VertexID / 2) * (2.0 * PI / float(CORNERS));\n"
	"	float inner = max(reach - 0.9 * margin, 0.0), outer = (reach + 0.9 * margin) / "
	"cos(PI / float(CORNERS));\n"
	"	reach = (gl_VertexID & 1) == 0 ? outer : inner;\n"
	"#else\n"
	"	float angle = (float(gl_VertexID) + 0.5) * (2.0 * PI / float(CORNERS));\n"
	"	reach = (reach + 1.5 * margin) / cos(PI / float(CORNERS));\n"
	"#endif\n"
	"	vec3 q = -lean * n + reach * (cos(angle) * a + sin(angle) * b);\n"
	"	ray = turned(q);\n"
	"	centre = vec4(turned(ball.xyz / ball.w), paint.w);\n"
	"	body = vec4(paint.rgb, ball.w);\n"
	"	spin = turn;\n"
	"	gl_Position = projection * vec4(ball.xyz + ball.w * q, 1.0);\n"
	"#ifdef EXACT\n"
	/* never cut off: fragments have their own depth */
	"	gl_Position.z = 0.5 * gl_Position.w;\n"
	"#endif\n"
	"#ifdef DEEP\n"
	"	sent_depth = depth;\n"
	"	sent_back = axes[2];\n"
	"#endif\n"
	"	SEND_AXIS\n"
	"	SEND\n"
	"}\n";

const char rb_shader_sphere_fragment[] =
	"in vec3 ray;\n"
	"flat in vec4 centre, body, spin;\n"
	"AXIS(in)\n"
	"#ifdef DEEP\n"
	"flat in vec4 sent_depth, sent_back;\n"
	"#endif\n"
	"out vec4 result;\n"
	"uniform sampler2D image;\n"
	"vec3 skin(vec3 n)\n"
	"{\n"
	"#if PATTERN == 1\n" /* checker: eight lunes, each in four bands */
	"	float f = n.x * n.y * (n.x * n.x - n.y * n.y) * n.z * (n.z * n.z - 0.36);\n"
	"	return mix(body.rgb, vec3(0.86), edge(f));\n"
	"#elif PATTERN == 2\n" /* stripes: seven bands */
	"	float f = abs(fract(1.75 * n.z + 0.25) - 0.5) - 0.25;\n"
	"	return mix(vec3(0.86), body.rgb, edge(f));\n"
	"#elif PATTERN == 3\n"
	"	return beachball(n, body.rgb);\n"
	"#elif PATTERN == 4\n" /* a picture of the whole globe */
	"	float u = atan(n.y, n.x) * (0.5 / PI), v = acos(clamp(n.z, -1.0, 1.0)) / PI;\n"
	"	float other = fract(u);\n" /* its seam is elsewhere: one of both is smooth */
	"	float du = min(fwidth(u), fwidth(other)), dv = fwidth(v);\n"
	"	return body.rgb * textureGrad(image, vec2(u + 0.5, v), vec2(du, 0.0), vec2(0.0, "
	"dv)).rgb;\n"
	"#else\n"
	"	return body.rgb;\n"
	"#endif\n"
	"}\n"
	"void main()\n"
	"{\n"
	"	vec3 u = SIGHT(centre.xyz + ray);\n"
	"	float b = dot(ray, u);\n"
	"	vec3 e = ray - b * u;\n" /* from the centre to the nearest point of the ray */
	"	float h2 = dot(e, e);\n"
	"#ifdef SAMPLES\n"
	"	float h = sqrt(h2), hx = dFdx(h), hy = dFdy(h);\n"
	"	int mask = 0;\n"
	"#define AT(k, x, y) mask |= h + (x) * hx + (y) * hy < 1.0 ? 1 << k : 0;\n"
	"	SAMPLES\n"
	"	gl_SampleMask[0] = mask;\n"
	"	const float cover = 1.0;\n"
	"#elif defined(SOFT)\n"
	"	float h = sqrt(h2);\n"
	"	vec2 g = vec2(dFdx(h), dFdy(h));\n"
	"	float cover = clamp(0.5 + (1.0 - h) * inversesqrt(dot(g, g) + 1e-20), 0.0, 1.0);\n"
	"#ifdef RIM\n"
	"	if (cover <= 0.0) discard;\n"
	"#else\n"
	"	if (cover < 1.0) discard;\n"
	"#endif\n"
	"#else\n"
	"	const float cover = 1.0;\n"
	"	if (h2 > 1.0) discard;\n"
	"#endif\n"
	"	vec3 N = e - sqrt(max(1.0 - h2, 0.0)) * u;\n"
	"	vec3 P = (centre.xyz + N) * body.w;\n"
	"#ifdef DEEP\n"
	"	float far = -dot(P, sent_back.xyz);\n"
	"#endif\n"
	"#ifdef EXACT\n"
	"	gl_FragDepth = DEPTH(sent_depth, far);\n"
	"#endif\n"
	"#ifdef CLIP\n"
	"	if (far < sent_depth.z || far > sent_depth.w) discard;\n"
	"#endif\n"
	"	vec3 albedo = skin(N + 2.0 * cross(spin.xyz, cross(spin.xyz, N) + spin.w * N));\n"
	"	result = vec4(tone(lit(P, N, -u, albedo, centre.w)), cover);\n"
	"}\n";

/* ---- planes ---- */

/* Corners may lie at infinity (w = 0): then the plane reaches its horizon. */
#define PLANE_VARYINGS(way) \
	"flat " way         \
	" vec4 normal_, axis_u_, axis_v_, paint_, other_, way_, way_x_, way_y_; AXIS(" way ")\n"

const char rb_shader_plane_vertex[] =
	"uniform vec4 corner[12];\n"
	"uniform vec4 normal;\n"         /* towards the eye; the eye's distance */
	"uniform vec4 axis_u, axis_v;\n" /* in textures per metre; textures at the eye's foot */
	"uniform vec4 paint;\n"          /* colour, exponent of the highlight */
	"uniform vec4 other;\n"          /* the second colour of a pattern */
	PLANE_VARYINGS("out") "CARRY(out)\n"
			      "void main()\n"
			      "{\n"
			      "	gl_Position = projection * corner[gl_VertexID];\n"
			      "	normal_ = vec4(turned(normal.xyz), normal.w); paint_ = paint; "
			      "other_ = other;\n"
			      "	axis_u_ = vec4(turned(axis_u.xyz), axis_u.w); axis_v_ = "
			      "vec4(turned(axis_v.xyz), axis_v.w);\n"
			      "	SEND_WAY;\n"
			      "	SEND\n"
			      "}\n";

const char rb_shader_plane_fragment[] = PLANE_VARYINGS(
	"in") "uniform sampler2D image;\n"
	      "out vec4 result;\n"
	      "void main()\n"
	      "{\n"
	      "	vec3 way = WAY;\n"
	      "	float fall = max(-dot(normal_.xyz, way), 1e-7);\n"
	      "	vec3 start = START;\n"
	      "	float t = (normal_.w + dot(normal_.xyz, start)) / fall;\n"
	      "	vec3 P = start + t * way;\n"
	      "	float scale = inversesqrt(dot(way, way));\n"
	      "	vec3 V = -scale * way;\n"
	      "	vec2 uv = vec2(axis_u_.w + dot(axis_u_.xyz, P), axis_v_.w + dot(axis_v_.xyz, P));\n"
	      "#if PATTERN == 1 || PATTERN == 3\n"
	      "	vec2 s = wave(uv, footprint(uv));\n"
	      "	vec3 albedo = mix(paint_.rgb, other_.rgb, 0.5 - 0.5 * s.x * s.y);\n"
	      "#elif PATTERN == 2\n"
	      "	vec2 s = wave(uv, footprint(uv));\n"
	      "	vec3 albedo = mix(paint_.rgb, other_.rgb, 0.5 - 0.5 * s.x);\n"
	      "#elif PATTERN == 4\n"
	      "	vec3 albedo = paint_.rgb * texture(image, uv).rgb;\n"
	      "#else\n"
	      "	vec3 albedo = paint_.rgb;\n"
	      "#endif\n"
	      "#ifdef GRID\n"
	      "	vec2 w = footprint(uv), g = abs(fract(uv - 0.5) - 0.5) / w;\n"
	      "	float line = max(clamp(1.2 - g.x, 0.0, 1.0) * clamp(1.5 - 5.0 * w.x, 0.0, 1.0),\n"
	      "		clamp(1.2 - g.y, 0.0, 1.0) * clamp(1.5 - 5.0 * w.y, 0.0, 1.0));\n"
	      "	result = vec4(paint_.rgb, 0.6 * line);\n"
	      "#else\n"
	      "	vec3 c = tone(lit(P, normal_.xyz, V, albedo, paint_.w));\n"
	      /* parallel lines of sight meet no horizon */
	      "#if defined(HAZE) && !defined(PARALLEL)\n"
	      "	c = mix(c, sky(-V), exp2(-70.0 * fall * scale));\n"
	      "#endif\n"
	      "	result = vec4(c, 1.0);\n"
	      "#endif\n"
	      "}\n";

/* ---- other solids ---- */

const char rb_shader_solid[] =
	"layout(location = 0) in vec4 unit;\n"
	"layout(location = 1) in vec3 normal;\n"
	"layout(location = 2) in vec2 axis;\n"
	"layout(location = 3) in vec2 tex;\n"
	"layout(location = 4) in vec4 body;\n"  /* centre, shift */
	"layout(location = 5) in vec4 turn;\n"  /* from object to view coordinates: x, y, z, w */
	"layout(location = 6) in vec4 size;\n"  /* scale, exponent of the highlight */
	"layout(location = 7) in vec4 paint;\n" /* colour */
	"layout(location = 8) in vec4 count;\n"
	"vec3 spun(vec3 p)\n"
	"{\n"
	"	return p + 2.0 * cross(turn.xyz, cross(turn.xyz, p) + turn.w * p);\n"
	"}\n"
	"vec3 corner()\n" /* object coordinates, from the middle */
	"{\n"
	"	return size.xyz * unit.xyz + vec3(0.0, 0.0, body.w * unit.w);\n"
	"}\n";

const char rb_shader_solid_vertex[] =
	"out vec3 point, across;\n" /* world axes, from the eye; the normal */
	"#if PATTERN == 3\n"
	"out vec3 way;\n" /* from the middle, in sizes */
	"#elif PATTERN > 0\n"
	"out vec2 skin;\n"
	"#endif\n"
	"flat out vec4 colour;\n"
	"CARRY(out)\n"
	"AXIS(out)\n"
	"float along(float k)\n"
	"{\n"
	"	return k < 0.5 ? count.x : k < 1.5 ? count.y : count.z;\n"
	"}\n"
	"void main()\n"
	"{\n"
	"	vec3 p = corner(), q = body.xyz + spun(p);\n"
	"	point = turned(q);\n"
	"	across = turned(spun(normal));\n"
	"#if PATTERN == 3\n"
	"	way = p / (size.xyz + vec3(0.0, 0.0, body.w));\n"
	"#elif PATTERN > 0\n"
	"	skin = vec2(along(axis.x) * tex.x, along(axis.y) * tex.y + count.w * unit.w);\n"
	"#endif\n"
	"	colour = vec4(paint.rgb, size.w);\n"
	"	gl_Position = projection * vec4(q, 1.0);\n"
	"	SEND_AXIS\n"
	"	SEND\n"
	"}\n";

const char rb_shader_solid_fragment[] =
	"in vec3 point, across;\n"
	"#if PATTERN == 3\n"
	"in vec3 way;\n"
	"#elif PATTERN > 0\n"
	"in vec2 skin;\n"
	"#endif\n"
	"flat in vec4 colour;\n"
	"AXIS(in)\n"
	"uniform sampler2D image;\n"
	"out vec4 result;\n"
	"void main()\n"
	"{\n"
	"#if PATTERN == 1\n"
	"	vec2 s = wave(skin, footprint(skin));\n"
	"	vec3 albedo = mix(colour.rgb, vec3(0.86), 0.5 - 0.5 * s.x * s.y);\n"
	"#elif PATTERN == 2\n"
	"	vec2 s = wave(skin, footprint(skin));\n"
	"	vec3 albedo = mix(colour.rgb, vec3(0.86), 0.5 - 0.5 * s.y);\n"
	"#elif PATTERN == 3\n"
	"	vec3 albedo = beachball(normalize(way), colour.rgb);\n"
	"#elif PATTERN == 4\n"
	"	vec3 albedo = colour.rgb * texture(image, vec2(0.5 + skin.x, 0.5 - skin.y)).rgb;\n"
	"#else\n"
	"	vec3 albedo = colour.rgb;\n"
	"#endif\n"
	"	result = vec4(tone(lit(point, normalize(across), -SIGHT(point), albedo, "
	"colour.w)), 1.0);\n"
	"}\n";

/* ---- sky ---- */

const char rb_shader_sky_vertex[] =
	"CARRY(out)\n"
	"flat out vec4 way_, way_x_, way_y_;\n"
	"AXIS(out)\n"
	"void main()\n"
	"{\n"
	"	vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);\n"
	"	gl_Position = vec4(p, SKY_DEPTH, 1.0);\n"
	"	SEND_WAY;\n"
	"	SEND\n"
	"}\n";

const char rb_shader_sky_fragment[] = "flat in vec4 way_, way_x_, way_y_;\n"
				      "AXIS(in)\n"
				      "out vec4 result;\n"
				      "void main()\n"
				      "{\n"
				      "	result = vec4(sky(normalize(WAY)), 1.0);\n"
				      "}\n";

/* ---- shadows ---- */

/*
 * What a sphere hides is what its disc across the light hides, and no point of its lit side lies
 * behind that disc: so there is neither a bias nor a shadow on itself.
 */
const char rb_shader_disc_vertex[] =
	"layout(location = 0) in vec4 ball;\n"
	"uniform mat4 to_map;\n" /* view to clip coordinates of the light */
	"uniform vec4 source;\n" /* w = 0: unit towards it, w = 1: where it is */
	"void main()\n"
	"{\n"
	"	vec3 way = source.w > 0.0 ? ball.xyz - source.xyz : -source.xyz;\n"
	"	float d = length(way), lean = source.w > 0.0 ? min(ball.w / d, 0.99) : 0.0;\n"
	"	vec3 n = way / d;\n"
	"	vec3 a = normalize(abs(n.y) < 0.9 ? vec3(-n.z, 0.0, n.x) : vec3(0.0, n.z, -n.y)), "
	"b = cross(n, a);\n"
	"	float angle = float(gl_VertexID) * (2.0 * PI / float(CORNERS));\n"
	"	float reach = sqrt(1.0 - lean * lean) * ROUND;\n"
	"	vec3 q = -lean * n + reach * (cos(angle) * a + sin(angle) * b);\n"
	"	gl_Position = to_map * vec4(ball.xyz + ball.w * q, 1.0);\n"
	"	FIX_DEPTH\n"
	"}\n";

const char rb_shader_flat_vertex[] = "uniform mat4 to_map;\n"
				     "uniform vec4 corner[12];\n"
				     "void main()\n"
				     "{\n"
				     "	gl_Position = to_map * corner[gl_VertexID];\n"
				     "	FIX_DEPTH\n"
				     "}\n";

const char rb_shader_solid_shadow[] =
	"uniform mat4 to_map;\n"
	"void main()\n"
	"{\n"
	"	gl_Position = to_map * vec4(body.xyz + spun(corner()), 1.0);\n"
	"	FIX_DEPTH\n"
	"}\n";

const char rb_shader_nothing[] = "void main()\n"
				 "{\n"
				 "}\n";

/* ---- lines and arrows ---- */

/*
 * A stroke from a to b, drawn as a ribbon of constant width in the picture; with a head it is an
 * arrow.
 */
const char rb_shader_line_vertex[] =
	"layout(location = 0) in vec4 from;\n" /* view coordinates, width in pixels */
	"layout(location = 1) in vec4 to;\n"   /* view coordinates, length of the head in pixels */
	"layout(location = 2) in vec4 from_paint;\n"
	"layout(location = 3) in vec4 to_paint;\n"
	"uniform vec2 size;\n" /* of the picture, pixels */
	"out vec2 at;\n"       /* pixels along and across */
	"out vec4 tint;\n"
	"flat out vec3 measure;\n" /* half width, head, length */
	"void main()\n"
	"{\n"
	"	vec4 a = vec4(from.x, from.y, KEPT(from.z), 1.0), b = vec4(to.x, to.y, KEPT(to.z), "
	"1.0);\n"
	"	float near = depth.z;\n"
	"	if (-a.z < near && -b.z > near) a = mix(b, a, (-b.z - near) / (a.z - b.z));\n"
	"	else if (-b.z < near && -a.z > near) b = mix(a, b, (-a.z - near) / (b.z - a.z));\n"
	"	vec4 ca = projection * a, cb = projection * b;\n"
	"	vec2 pa = ca.xy / ca.w * size * 0.5, pb = cb.xy / cb.w * size * 0.5;\n"
	"	float length_px = length(pb - pa);\n"
	"	vec2 along = length_px > 1e-3 ? (pb - pa) / length_px : vec2(1.0, 0.0), across = "
	"vec2(-along.y, along.x);\n"
	"	float head = min(to.w, 0.6 * length_px), half_width = 0.5 * from.w;\n"
	"	float reach = max(half_width, 0.45 * head) + 2.0 + RIM;\n"
	"	bool end = (gl_VertexID & 1) != 0, left = (gl_VertexID & 2) != 0;\n"
	"	float margin = to.w > 0.0 ? 1.0 + RIM : JOINT;\n"
	"	at = vec2(end ? length_px + margin : -margin, left ? reach : -reach);\n"
	"	tint = end ? to_paint : from_paint;\n"
	"	measure = vec3(half_width, head, length_px);\n"
	"	vec4 c = end ? cb : ca;\n"
	"	vec2 p = (end ? pb + margin * along : pa - margin * along) + at.y * across;\n"
	"	gl_Position = vec4(p * 2.0 / size * c.w, c.zw);\n"
	"	if ((-a.z < near && -b.z < near) || (to.w > 0.0 && length_px < 2.0)) gl_Position = "
	"vec4(0.0, 0.0, 0.0, -1.0);\n"
	"}\n";

const char rb_shader_line_fragment[] =
	"in vec2 at;\n"
	"in vec4 tint;\n"
	"flat in vec3 measure;\n"
	"out vec4 result;\n"
	"void main()\n"
	"{\n"
	"	float start = measure.z - measure.y;\n"
	"	float shaft = max(abs(at.y) - measure.x, max(-at.x, at.x - measure.z + 0.5 * "
	"measure.y) - JOINT);\n"
	"	float head = max((abs(at.y) - 0.42 * (measure.z - at.x)) * 0.92, start - at.x);\n"
	"	float d = measure.y > 0.0 ? min(shaft, head) : shaft;\n"
	"	float cover = clamp(0.5 - d, 0.0, 1.0), rim = clamp(0.5 + RIM - d, 0.0, 1.0);\n"
	"	vec3 c = tint.rgb * (RIM > 0.0 ? cover / max(rim, 1e-3) : 1.0);\n"
	"	result = vec4(c, tint.a * rim);\n"
	"}\n";
