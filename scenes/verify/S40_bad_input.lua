-- SPDX-License-Identifier: MIT
-- S40: what no scene may hold. Answer: each is refused before the first step, with the body and the key. Nothing is varied,
-- since nothing runs.
local fault = param("fault", "mass_zero", "what is wrong", {choices = {
	"mass_zero", "mass_negative", "mass_nan", "mass_infinite", "radius_zero", "radius_negative", "radius_tiny",
	"restitution_high", "restitution_negative", "restitution_nan", "friction_negative", "friction_nan",
	"step_zero", "step_negative", "step_nan", "quaternion_zero", "quaternion_long", "position_nan", "velocity_infinite",
	"plate_zero", "name_twice", "unknown_key", "many", "empty"}})
param("quick", "all", "what --quick runs", {choices = {"all"}})
param("processor_seconds", 600.0, "what a run may take", {min = 0})
local nan, infinite = 0 / 0, 1 / 0

local bodies = {
	mass_zero = {mass = 0}, mass_negative = {mass = -1}, mass_nan = {mass = nan}, mass_infinite = {mass = infinite},
	radius_zero = {radius = 0}, radius_negative = {radius = -1}, radius_tiny = {radius = 1e-320},
	quaternion_zero = {orientation = {0, 0, 0, 0}}, quaternion_long = {orientation = {2, 0, 0, 0}},
	position_nan = {position = {0, nan, 0}}, velocity_infinite = {velocity = {infinite, 0, 0}}, unknown_key = {raduis = 1}}
local materials = {
	restitution_high = {restitution = 1.1}, restitution_negative = {restitution = -0.1}, restitution_nan = {restitution = nan},
	friction_negative = {friction = -0.1}, friction_nan = {friction = nan}}
local steps = {step_zero = 0, step_negative = -1, step_nan = nan}

world { title = "Bad input", duration = 1, time_step = steps[fault] or 0.01 }
if bodies[fault] then
	local keys = {name = "ball", radius = 0.1}
	for key, value in pairs(bodies[fault]) do
		if key ~= "raduis" then keys[key] = value else keys.raduis, keys.radius = value, nil end
	end
	sphere(keys)
	local key = fault:match("^%a+")
	key = ({quaternion = "orientation", unknown = "raduis"})[key] or key
	expect_refused(65, "sphere 'ball'.*" .. key)
elseif materials[fault] then
	materials[fault].name = "stuff"
	material(materials[fault])
	sphere { name = "ball", radius = 0.1 }
	expect_refused(65, "material 'stuff'.*" .. fault:match("^%a+"))
elseif steps[fault] then
	sphere { name = "ball", radius = 0.1 }
	expect_refused(65, "world.*time_step")
elseif fault == "plate_zero" then
	sphere { name = "ball", radius = 0.1, position = {0, 0, 1} }
	plane { name = "plate", size = {0, 1} }
	expect_refused(65, "plane 'plate'.*size")
elseif fault == "name_twice" then
	sphere { name = "ball", radius = 0.1 }
	sphere { name = "ball", radius = 0.1, position = {0, 0, 1} }
	expect_refused(65, "'ball'.*name")
elseif fault == "many" then
	expect_refused(65, "memory")
	for i = 1, 10000000 do sphere { radius = 0.1, position = {0, 0, i} } end
elseif fault == "empty" then
	expect_refused(65, "body")
end
