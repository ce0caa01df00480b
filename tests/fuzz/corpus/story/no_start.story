task give mug
