error { message = "the braid needs three bundles", hint = "give it three" }
