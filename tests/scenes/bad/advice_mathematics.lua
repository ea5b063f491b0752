world { duration = 1 }
sphere { radius = sqrt(2) }
-- expect: :2: attempt to call a nil value (global 'sqrt') (math.sqrt)
