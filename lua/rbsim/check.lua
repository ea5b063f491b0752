-- SPDX-License-Identifier: MIT
-- rbsim.check: what the other helpers use to look at their arguments. An error points at the line of the scene that
-- called the helper, not into the helper.
--
--   local o = check.options("lattice.cubic", o, {count = "counts", spacing = "positive"}, {center = "vector"})
--
-- The first table of kinds lists what must be there, the second what may be.

local check = {}

local function finite(x)
	return type(x) == "number" and x == x and x ~= math.huge and x ~= -math.huge
end

local function vector(v)
	return type(v) == "table" and #v == 3 and finite(v[1]) and finite(v[2]) and finite(v[3])
end

local function whole(x)
	return math.type(x) == "integer" or (finite(x) and x == math.floor(x))
end

local kinds = {
	number = {finite, "a number"},
	positive = {function(x) return finite(x) and x > 0 end, "a positive number"},
	["not negative"] = {function(x) return finite(x) and x >= 0 end, "a number, 0 or more"},
	count = {function(x) return whole(x) and x >= 1 end, "a whole number, 1 or more"},
	counts = {function(v) return vector(v) and whole(v[1]) and whole(v[2]) and whole(v[3])
		and v[1] >= 1 and v[2] >= 1 and v[3] >= 1 end, "three whole numbers {nx, ny, nz}, 1 or more"},
	vector = {vector, "a vector {x, y, z}"},
	size = {function(v) return vector(v) and v[1] > 0 and v[2] > 0 and v[3] > 0 end, "three positive numbers {x, y, z}"},
	text = {function(x) return type(x) == "string" end, "a text"},
	table = {function(x) return type(x) == "table" end, "a table"},
	boolean = {function(x) return type(x) == "boolean" end, "true or false"},
	["function"] = {function(x) return type(x) == "function" end, "a function"},
	any = {function() return true end, "anything"},
}

-- `depth` counts calls between the scene and the function that raises.
function check.value(call, key, value, kind, depth)
	local is, wanted = table.unpack(kinds[kind])
	if not is(value) then
		local got = type(value) == "number" and tostring(value) or type(value)
		error(("%s: '%s' must be %s (got %s)"):format(call, key, wanted, got), (depth or 1) + 2)
	end
	return value
end

function check.options(call, options, needed, optional)
	if type(options) ~= "table" then
		error(("%s: expected a table of options (got %s)"):format(call, type(options)), 3)
	end
	for key in pairs(options) do
		if not (needed[key] or optional[key]) then
			local known = {}
			for name in pairs(needed) do known[#known + 1] = name end
			for name in pairs(optional) do known[#known + 1] = name end
			table.sort(known)
			error(("%s: unknown option '%s' (there are %s)"):format(call, tostring(key), table.concat(known, ", ")), 3)
		end
	end
	for key, kind in pairs(needed) do
		if options[key] == nil then
			error(("%s: option '%s' is missing"):format(call, key), 3)
		end
		check.value(call, key, options[key], kind, 2)
	end
	for key, kind in pairs(optional) do
		if options[key] ~= nil then check.value(call, key, options[key], kind, 2) end
	end
	return options
end

-- A copy of a body's keys with others on top.
function check.with(keys, more)
	local all = {}
	for key, value in pairs(keys or {}) do all[key] = value end
	for key, value in pairs(more) do all[key] = value end
	return all
end

return check
