local x = math.random()
world { duration = 1, seed = 7 }
-- expect: :2: world: 'seed' must come before the first random number is drawn
