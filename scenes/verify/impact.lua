-- SPDX-License-Identifier: MIT
-- What several cases share: the impact of a solid sphere on a wall, as rigid bodies with Coulomb's friction have it
-- (Chung and Ooi, Granul. Matter 13, 2011, test 4, and the mechanics of a rigid sphere).
local impact = {}

-- Normal speed towards the wall, speed along it, spin times radius (positive: rolling along) -> the same afterwards.
-- The contact slips throughout where the impulse that would stop it, 2/7 of the slip, is beyond friction's.
function impact.sphere(vn, vt, wr, e, mu)
	local slip = vt - wr
	local stop, most = slip * 2 / 7, mu * (1 + e) * vn
	local j = math.abs(stop) <= most and stop or (slip > 0 and most or -most)
	return e * vn, vt - j, wr + 2.5 * j
end

-- A sphere above a floor, thrown: lists of flights {time, height, vz, x, vx, wr}, the first from the start, until `duration`.
-- Heights are of its lowest point.
function impact.flights(o, duration)
	local at = {time = 0, height = o.height, vz = o.vz, x = 0, vx = o.vx, wr = o.wr}
	local list = {at}
	while true do
		local root = math.sqrt(at.vz * at.vz + 2 * o.g * at.height)
		-- without cancellation for either sign
		local fall = at.vz >= 0 and (at.vz + root) / o.g or 2 * at.height / (root - at.vz)
		if at.time + fall > duration then return list end
		local vz, vx, wr = impact.sphere(root, at.vx, at.wr, o.e, o.mu)
		at = {time = at.time + fall, height = 0, vz = vz, x = at.x + at.vx * fall, vx = vx, wr = wr}
		list[#list + 1] = at
	end
end

-- {x, height, vx, vz, wr} at a time.
function impact.at(list, g, t)
	local k = #list
	while k > 1 and list[k].time > t do k = k - 1 end
	local f = list[k]
	local s = t - f.time
	return {x = f.x + f.vx * s, height = f.height + (f.vz - g * s / 2) * s, vx = f.vx, vz = f.vz - g * s, wr = f.wr}
end

return impact
