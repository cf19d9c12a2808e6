!> Searches for extremes of each column of each row between one node and those before it.
!>
!> Between two nodes a coordinate has an extreme where its velocity is zero, a velocity where its acceleration is, and
!> an acceleration where its five-point difference is. Each zero lies between two times at which that derivative has
!> opposite signs, and is found there by motions at times between the instants. The differences beside both nodes tell
!> whether the acceleration has an extreme between them, and three nodes whether it has one beside the middle one;
!> where it has another sign there, its two zeros are searched for, and likewise those of the velocity. So none is
!> missed of an acceleration that has at most one extreme in a step.
module column_search
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use points, only: coordinates_of
   use set_analysis, only: set_analysis_t
   use nodes, only: node_t, node_at
   use zero_search, only: sample_t, column_t, find_zero, differ_in_sign
   use extremes, only: extremes_t, offer, count_turn, alike, noise_part, step_of
   implicit none
   private
   public :: add_node

   !> The step of the five-point difference, whose error goes with its fourth power, in steps of TIME; and how much
   !> longer it may be in short steps, in rad or lengths.
   real(wp), parameter :: difference_part = 1.0_wp/256.0_wp, difference_angle = 1.0e-3_wp, max_part = 1.0_wp/8.0_wp
   !> Nodes closer to each other, in steps of TIME, have no derivatives of accelerations between them.
   real(wp), parameter :: least_part = 1.0_wp/16.0_wp

contains

   !> Takes `node` of mechanism `c`, and searches between it and the last two.
   subroutine add_node(x, m, s, c, node)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      type(node_t), intent(in) :: node
      real(wp) :: jerk(3, size(x%asked), 2), step
      integer :: i, j, k

      associate (track => x%tracks(c))
         step = 0.0_wp
         if (size(track%last) > 0) call find_jerks(x, m, s, c, track%last(1), node, jerk, step)
         do i = 1, size(track%rows)
            associate (q => track%rows(i))
               do j = 1, coordinates_of(m%requests(x%asked(q))%kind)
                  do k = 0, node%known(q)
                     call offer(x, m, q, j, k, sample_of(node, q, j), .false.)
                  end do
                  if (node%known(q) < 2) cycle
                  call count_turn(x, q, j, node%value(j, 1, q))
                  call search_column(x, m, s, q, column_t(x%asked(q), j, step), [node_t :: node, track%last], &
                     jerk(j, q, :), track%turned(j, q))
               end do
            end associate
         end do
         track%last = [node_t :: node, track%last(:min(size(track%last), 1))]
      end associate
   end subroutine add_node

   !> Searches for extremes of the `column` of row `q` between the first of the `nodes`, latest first, and the others.
   !> `jerk` (2): see `find_jerks`. `turned`: an extreme of the acceleration was found between the second and the third,
   !> and then between the first and the second.
   subroutine search_column(x, m, s, q, column, nodes, jerk, turned)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(node_t), intent(in) :: nodes(:)
      real(wp), intent(in) :: jerk(2)
      logical, intent(inout) :: turned
      type(sample_t) :: now, before, earlier
      type(column_t) :: c
      logical :: turned_before

      turned_before = turned
      turned = .false.
      if (size(nodes) < 2) return
      before = sample_of(nodes(2), q, column%column)
      if (.not. before%exists) return
      now = sample_of(nodes(1), q, column%column)
      c = column
      c%noise(:2) = max(noise_part*x%size_of(column%column, :, q), now%error, before%error)
      call search_velocity(x, m, s, q, c, before, now)
      call search_turn(x, m, s, q, c, before, now, jerk, turned)
      if (size(nodes) < 3 .or. turned .or. turned_before) return
      earlier = sample_of(nodes(3), q, column%column)
      if (earlier%exists) call search_acceleration(x, m, s, q, c, earlier, before, now)
   end subroutine search_column

   !> Column `c` of row `q` of `node`.
   pure type(sample_t) function sample_of(node, q, c) result(sample)
      type(node_t), intent(in) :: node
      integer, intent(in) :: q, c

      sample = sample_t(node%t, node%value(c, :, q), node%error(c, :, q), node%known(q) == 2)
   end function sample_of

   !> Extremes of the coordinate between `a` and `b`, whose accelerations have one sign.
   subroutine search_coordinate(x, m, s, q, column, a, b)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(sample_t), intent(in) :: a, b
      type(sample_t) :: zero

      if (.not. changes_sign(column, 1, a, b)) return
      call find_zero(s, column, 1, 0.0_wp, a, b, zero)
      if (zero%exists) call offer(x, m, q, column%column, 0, zero, .true.)
   end subroutine search_coordinate

   !> Extremes of the velocity between `a` and `b`, and of the coordinate on either side of them.
   subroutine search_velocity(x, m, s, q, column, a, b)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(sample_t), intent(in) :: a, b
      type(sample_t) :: zero

      if (changes_sign(column, 2, a, b)) call find_zero(s, column, 2, 0.0_wp, a, b, zero)
      if (zero%exists) then
         call offer(x, m, q, column%column, 1, zero, .true.)
         call search_coordinate(x, m, s, q, column, a, zero)
         call search_coordinate(x, m, s, q, column, zero, b)
      else
         call search_coordinate(x, m, s, q, column, a, b)
      end if
   end subroutine search_velocity

   !> An extreme of the acceleration between `a` and `d`, if it is the largest or least at `b`: it may be beside `b`.
   subroutine search_acceleration(x, m, s, q, column, a, b, d)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(sample_t), intent(in) :: a, b, d
      type(column_t) :: c
      real(wp) :: error(0:2)
      logical :: found

      error = max(a%error, b%error, d%error)
      associate (up => b%f(2) - a%f(2), down => b%f(2) - d%f(2), &
                 open => alike*x%size_of(column%column, 2, q) + error(2))
         ! Beside an extreme halfway between two instants both have the same value.
         if (max(abs(up), abs(down)) <= open) return
         if (differ_in_sign(up, down) .and. min(abs(up), abs(down)) > open) return
      end associate
      c = column
      c%step = difference_step(x, step_of(m), q, c%column, min(abs(b%t - a%t), abs(d%t - b%t)))
      if (c%step > 0.0_wp) call take_turn(x, m, s, q, c, a, d, error, found)
   end subroutine search_acceleration

   !> Takes the extreme of the acceleration between `a` and `b`, if it is `found`; where the acceleration has another
   !> sign there, the extremes of the velocity on either side. `error` (0:2) of the values about it.
   subroutine take_turn(x, m, s, q, column, a, b, error, found)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(sample_t), intent(in) :: a, b
      real(wp), intent(in) :: error(0:2)
      logical, intent(out) :: found
      type(column_t) :: c
      type(sample_t) :: zero

      c = column
      c%noise(3) = c%noise(2)/c%step
      call find_zero(s, c, 3, 0.0_wp, sample_t(t=a%t + 2.0_wp*x%way*c%step), &
         sample_t(t=b%t - 2.0_wp*x%way*c%step), zero)
      found = zero%exists
      if (.not. found) return
      zero%error = max(zero%error, error)
      call offer(x, m, q, c%column, 2, zero, .true.)
      if (.not. (changes_sign(c, 2, a, zero) .and. changes_sign(c, 2, zero, b))) return
      call search_velocity(x, m, s, q, c, a, zero)
      call search_velocity(x, m, s, q, c, zero, b)
   end subroutine take_turn

   !> An extreme of the acceleration between `a` and `b` where its derivatives `jerk` beside both have different signs;
   !> `found`: there is one.
   subroutine search_turn(x, m, s, q, column, a, b, jerk, found)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(sample_t), intent(in) :: a, b
      real(wp), intent(in) :: jerk(2)
      logical, intent(out) :: found

      found = .false.
      if (column%step <= 0.0_wp) return
      if (differ_in_sign(jerk(1), jerk(2)) .and. minval(abs(jerk)) > column%noise(2)/column%step) &
         call take_turn(x, m, s, q, column, a, b, max(a%error, b%error), found)
   end subroutine search_turn

   !> The derivatives (3, asked, 2) of the accelerations between the nodes `a` and `b` of mechanism `c`, two steps of
   !> the difference from either; `step`: that, 0 where the nodes are close to each other or some motion does not exist.
   subroutine find_jerks(x, m, s, c, a, b, jerk, step)
      type(extremes_t), intent(in) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      type(node_t), intent(in) :: a, b
      real(wp), intent(out) :: jerk(:, :, :), step
      type(node_t) :: near(3)
      real(wp) :: h
      integer :: i, k

      jerk = 0.0_wp
      step = 0.0_wp
      if (abs(b%t - a%t) < least_part*step_of(m)) return
      associate (rows => x%tracks(c)%rows)
         if (any(a%known(rows) < 2 .or. b%known(rows) < 2)) return
         h = x%way*difference_step(x, step_of(m), rows(1), 1, 0.5_wp*abs(b%t - a%t))
         do k = 1, 2
            if (k == 2) h = -h
            do i = 1, 3
               near(i) = node_at(x%asked, s, c, merge(a%t, b%t, k == 1) + h*merge(i, i + 1, i == 1), .false.)
               if (any(near(i)%known(rows) < 2)) return
            end do
            jerk(:, :, k) = 8.0_wp*(near(2)%value(:, 2, :) - near(1)%value(:, 2, :)) - near(3)%value(:, 2, :)
            if (k == 1) jerk(:, :, k) = (jerk(:, :, k) + a%value(:, 2, :))/(12.0_wp*h)
            if (k == 2) jerk(:, :, k) = (jerk(:, :, k) + b%value(:, 2, :))/(12.0_wp*h)
         end do
      end associate
      step = abs(h)
   end subroutine find_jerks

   !> The step of the difference for column `c` of row `q`, nodes being `apart` and instants a `step` of TIME.
   pure real(wp) function difference_step(x, step, q, c, apart)
      type(extremes_t), intent(in) :: x
      real(wp), intent(in) :: step, apart
      integer, intent(in) :: q, c

      difference_step = max(difference_part*step, difference_angle*x%size_of(c, 0, q)/x%size_of(c, 1, q))
      difference_step = min(difference_step, max_part*apart)
   end function difference_step

   !> Derivative number `k` (1, 2) of the column `c` changes its sign between `a` and `b`, by more than rounding.
   pure logical function changes_sign(c, k, a, b)
      type(column_t), intent(in) :: c
      integer, intent(in) :: k
      type(sample_t), intent(in) :: a, b

      changes_sign = differ_in_sign(a%f(k), b%f(k)) .and. min(abs(a%f(k)), abs(b%f(k))) > c%noise(k)
   end function changes_sign

end module column_search
