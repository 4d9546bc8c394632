@table = internal constant [16 x i8] c"\\\22\00\00\00\00\00\00\00\00\00\00\00\00\04@", align 8
define i64 @ENTRY(i64 %op, ptr %p, ptr %d, ptr %u, ptr %x, ptr %y, ptr %w, double %h) local_unnamed_addr #0 {
entry:
  %m = alloca [3 x double], align 8
  %x1 = getelementptr inbounds nuw i8, ptr %x, i64 8
  %e = load double, ptr %x1, align 8
  %t = fmul double %e, 2.000000e+00
  store double %t, ptr %y, align 8
  %half_pair = insertvalue { double, i8 } undef, double 1.5, 0
  %pair = insertvalue { double, i8 } %half_pair, i8 7, 1
  %whole = fptosi double %e to i64
  %rest = srem i64 %whole, 3
  %half = ashr i64 %whole, 1
  %short = trunc i64 %whole to i8
  %long = sext i8 %short to i64
  %sum = add nsw i64 %rest, %half
  %two = mul i64 %sum, -2
  %least = tail call i64 @llvm.smin.i64(i64 %two, i64 %long)
  %back = sitofp i64 %least to double
  %y2 = getelementptr inbounds nuw i8, ptr %y, i64 16
  store double %back, ptr %y2, align 8
  %n = load i64, ptr @table, align 8
  %as = uitofp i64 %n to double
  %index = and i64 %n, 1
  %at = getelementptr double, ptr %y2, i64 1
  %place = getelementptr [8 x i8], ptr %at, i64 %index
  store double %as, ptr %place, align 8
  call void @llvm.memset.p0.i64(ptr %m, i8 0, i64 24, i1 false)
  call void @llvm.memcpy.p0.p0.i64(ptr %m, ptr %x, i64 8, i1 false)
  %y1 = getelementptr inbounds nuw i8, ptr %y, i64 8
  call void @llvm.memcpy.p0.p0.i64(ptr %y1, ptr align 8 getelementptr inbounds nuw (i8, ptr @table, i64 8), i64 8, i1 false)
  %kept = load double, ptr %m, align 8
  br label %loop
loop:                                             ; preds = %loop, %entry
  %i = phi i64 [ 0, %entry ], [ %next, %loop ]
  %first = phi double [ %kept, %entry ], [ %second, %loop ]
  %second = phi double [ 1.000000e+00, %entry ], [ %first, %loop ]
  %either = phi { double, i8 } [ %pair, %entry ], [ { double 2.5, i8 3 }, %loop ]
  %next = add i64 %i, 1
  %more = icmp slt i64 %next, 4
  br i1 %more, label %loop, label %end
end:                                              ; preds = %loop
  %w48 = getelementptr i8, ptr %y, i64 48
  store { double, i8 } %either, ptr %w48, align 8
  %y4 = getelementptr i8, ptr %y, i64 32
  store double %first, ptr %y4, align 8
  %none = fcmp uno double %h, 0x7FF8000000000000
  %chosen = select i1 %none, double -0.000000e+00, double 0x7FF0000000000000
  %y5 = getelementptr i8, ptr %y, i64 40
  store double %chosen, ptr %y5, align 8
  %below = fcmp ult double %h, %kept
  %bit = zext i1 %below to i64
  switch i64 %bit, label %no [
    i64 1, label %yes
  ]
yes:                                              ; preds = %end
  ret i64 -1
no:                                               ; preds = %end
  ret i64 2
}
