world { duration = 1 }
mesh {}
-- expect: :2: attempt to call a nil value (global 'mesh') (meshes are not in this version; hull { file = ... } is the convex solid of an STL or OBJ file)
