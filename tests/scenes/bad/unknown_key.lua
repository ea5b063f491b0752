world { duration = 1 }
sphere { name = "ball", raduis = 1 }
sphere { radius = 1, positon = {0, 0, 5}, zzz = 1 }
-- expect: :2: sphere 'ball': unknown key 'raduis' (did you mean 'radius'?)
-- expect: :3: sphere: unknown key 'positon' (did you mean 'position'?)
-- expect: :3: sphere: unknown key 'zzz'
