!> What the listing says of a mechanism's structure: the counts (12) and (13), and its Assur groups.
module listing_structure
   use mechanism, only: mechanism_t
   use structure, only: findings_t, group_t
   use text_output, only: output_t, put, add
   use numerals, only: whole
   use phrases, only: phrase, say_structure, say_links, say_ground, say_revolute, say_prismatic, say_coordinates, &
      say_equations, say_degrees_of_freedom, say_drives, say_groups, say_driven, say_not_needed
   implicit none
   private
   public :: put_structure

   integer, parameter :: links_a_line = 10

contains

   !> Counts and groups `f` of `m`.
   subroutine put_structure(o, m, f)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: f

      associate (pl => m%polish)
         call put(o, ' '//phrase(say_structure, pl))
         call put(o, ' '//phrase(say_links, pl)//' '//whole(f%links)//', '//phrase(say_ground, pl) &
            //' '//whole(f%ground)//';  '//phrase(say_revolute, pl)//' '//whole(f%revolute) &
            //';  '//phrase(say_prismatic, pl)//' '//whole(f%prismatic))
         call put(o, ' '//phrase(say_coordinates, pl)//' W = '//whole(f%coordinates)//';  '//phrase(say_equations, pl) &
            //' R = '//whole(f%equations)//';  '//phrase(say_degrees_of_freedom, &
            pl)//' S = '//whole(f%degrees_of_freedom) &
            //';  '//phrase(say_drives, pl)//' '//whole(f%drives))
      end associate
      if (allocated(f%groups)) call put_groups(o, m, f%groups)
   end subroutine put_structure

   !> A line of links for each group, continued where they are many.
   subroutine put_groups(o, m, groups)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(group_t), intent(in) :: groups(:)
      character(18) :: head
      integer :: i, k

      if (size(groups) > 0) call put(o, ' '//phrase(say_groups, m%polish))
      do i = 1, size(groups)
         write (head, '(i6)') i
         if (groups(i)%driven) head(9:) = phrase(say_driven, m%polish)
         if (.not. groups(i)%needed) head(9:) = phrase(say_not_needed, m%polish)
         do k = 1, size(groups(i)%links)
            if (mod(k, links_a_line) == 1) call add(o, ' '//head)
            if (k == size(groups(i)%links) .or. mod(k, links_a_line) == 0) then
               call put(o, ' '//trim(m%links(groups(i)%links(k))%name))
            else
               call add(o, ' '//m%links(groups(i)%links(k))%name)
            end if
            head = ''
         end do
      end do
   end subroutine put_groups
end module listing_structure
