"""What all tests share: shared helpers are importable as `rod.helpers`."""
