!> Cylinders along a motion: the limit at which a length comes to its bound, and the flag of a motion out of a stroke.
module strokes
   use kinds, only: wp
   use mechanism, only: drive_slide
   use motion, only: motion_t, add_diagnostics, diagnostic_t, diagnostic_limit, diagnostic_stroke, flag_none, &
      flag_stroke
   use drive_path, only: drive_at
   use scales, only: is_length
   use drawn_lengths, only: rounded => same_place_tolerance
   use cylinders, only: cylinder_t, cylinder_length, is_out_of_stroke
   use block_diagnostics, only: near_limit_part
   use continuation, only: continuation_t, lengths_followed
   implicit none
   private
   public :: find_length_limit, flag_strokes

contains

   !> Finds the limit at which the length of a cylinder comes to its bound, if the motion has come within
   !> `near_limit_part` of the step to it. Of several cylinders the nearest limit counts.
   subroutine find_length_limit(continuation, t, list)
      type(continuation_t), intent(in) :: continuation     !< a motion that did not reach `t`
      real(wp), intent(in) :: t                            !< time to which the step goes, in the deck's unit
      type(diagnostic_t), allocatable, intent(inout) :: list(:)   !< then this limit only; without one it stays
      type(diagnostic_t) :: limit
      real(wp) :: lengths(0:2, size(continuation%geometry%cylinders)), f(3), way, left, nearest
      integer :: d, k, side

      lengths = lengths_followed(continuation)
      nearest = near_limit_part*abs(t - continuation%place%t)
      do k = 1, size(continuation%geometry%cylinders)
         associate (bounds => continuation%geometry%cylinders(k)%bounds, length => lengths(0, k), rate => lengths(1, k))
            if (abs(rate) <= rounded*maxval(abs(lengths(1, :)))) cycle   ! its length is fixed: the rate is rounding
            do side = 1, 2
               if (bounds(side) >= huge(1.0_wp)) cycle
               way = bounds(side) - length
               if (merge(length <= bounds(1), length >= bounds(2), side == 1)) way = 0.0_wp   ! begins at or beyond it
               if (abs(way) > nearest*abs(rate)) cycle
               left = way/rate
               if (left*sign(1.0_wp, t - continuation%t) < 0.0_wp) cycle
               nearest = abs(left)
               limit = diagnostic_t(kind=diagnostic_limit, pair=continuation%geometry%cylinders(k)%pair, &
                  t=continuation%t + left, value=bounds(side), other=bounds(side) > 0.0_wp)
            end do
         end associate
      end do
      if (limit%pair == 0) return

      do d = 1, size(continuation%path%laws)
         f = drive_at(continuation%path, d, limit%t)
         if (limit%drive > 0 .and. abs(f(2)) <= 0.0_wp) cycle
         limit%drive = d
         if (abs(f(2)) > 0.0_wp) exit
      end do
      associate (law => continuation%path%laws(limit%drive))
         limit%is_angle = .not. is_length(law)
         f = drive_at(continuation%path, limit%drive, limit%t)
         if (law%kind /= drive_slide .or. law%subject /= limit%pair) limit%value = f(1)
      end associate
      list = [limit]
   end subroutine find_length_limit

   !> Flags a complete motion if a cylinder is out of its stroke, and adds a diagnostic for each such cylinder. An
   !> incomplete or flagged motion stays.
   subroutine flag_strokes(cylinders, found)
      type(cylinder_t), intent(in) :: cylinders(:)         !< (any number)
      type(motion_t), intent(inout) :: found               !< of all links
      integer :: k

      if (found%known < 2 .or. found%flag /= flag_none) return
      do k = 1, size(cylinders)
         associate (one => cylinders(k), length => cylinder_length(cylinders(k), found%position(:, cylinders(k)%i), &
            found%position(:, cylinders(k)%j)))
            if (.not. is_out_of_stroke(one%stroke, length)) cycle
            found%flag = flag_stroke
            call add_diagnostics([diagnostic_t(kind=diagnostic_stroke, pair=one%pair, value=length)], found)
         end associate
      end do
   end subroutine flag_strokes
end module strokes
