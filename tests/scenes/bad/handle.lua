local ball = sphere { radius = 1 }
print(ball.positoin)
-- expect: :2: body #0 has no field 'positoin' (did you mean 'position'?)
