world { duration = 1 }
mesh {}
-- expect: :2: attempt to call a nil value (global 'mesh') (of an STL or OBJ file, hull { file = ... } is the convex solid, and terrain { file = ... } its triangles, which are static)
